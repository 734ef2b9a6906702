// The list of runs that tests need, and processes that share it.
#include "dem/runs/run_list.hpp"

#include <thread>

#include "dem/runs/dataset_runs.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

std::vector<PlannedTest> small_plan() {
  return plan(
      spec_from_json(parse_json(
                         R"({"particles": 32, "strain_rate": 20000, "rows": 20, "densities": [0.74], "nu_end": 0.70,
      "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "strain": 0.02, "role": "calibration"}, {"mode": "UNI", "strain": 0.01, "role": "validation"}]})",
                         "s.json", JsonSource::user),
                     "s.json"));
}

// However a test came to ask for them: a file that is read is refused before, by name.
TEST(RunList, HasNoFramesAndNoProbesOfLammps) {
  auto planned = small_plan();
  for (PlannedTest& test : planned) test.preparation.choice.engine = EngineName::lammps;
  EXPECT_EQ(runs_of(planned).size(), 6u);
  planned[1].frames = 3;
  EXPECT_EQ(
      testing::refusal([&] { runs_of(planned); }),
      "test '" + planned[1].name + "': frames: belongs to the engine 'grainlaw'; remove it from what LAMMPS runs");
  planned[1].frames = 0;
  planned[1].probes.emplace();
  EXPECT_NE(testing::refusal([&] { runs_of(planned); }).find("probes: belongs to the engine 'grainlaw'"),
            std::string::npos);
}

class RunLists : public testing::TemporaryFolder {};

// Two that work on the same runs at once share them: each run is made once.
TEST_F(RunLists, AreSharedByThoseWhoWorkInOneStore) {
  const auto planned = small_plan();
  const auto runs = runs_of(planned);
  const auto work = [&](RunCounts& counts, MissingRuns missing) {
    const RunStore store(folder_, "runs");
    make_runs(runs, store, {.threads = 2}, counts, missing);
  };
  RunCounts one, other, waiting;
  {
    const std::jthread a([&] { work(one, MissingRuns::simulated); }), b([&] { work(other, MissingRuns::simulated); }),
        c([&] { work(waiting, MissingRuns::awaited); });
  }
  const auto made = [](const RunCounts& counts) { return counts.runs - counts.found - counts.others; };
  EXPECT_EQ(made(one) + made(other), 6u);
  EXPECT_EQ(made(waiting), 0u);
  EXPECT_EQ(waiting.runs, 6u);
  for (const PlannedRun& run : runs) EXPECT_TRUE(is_finished(folder_ / "runs", run.key));
  for (const auto& entry : fs::directory_iterator(folder_ / "runs"))
    EXPECT_FALSE(entry.path().filename().string().find(".lock") != std::string::npos) << entry.path();
}

TEST_F(RunLists, AreLeftToOthersWhoHoldTheirLocks) {
  const auto planned = small_plan();
  const auto runs = with_preparations(runs_of(planned), {2});
  ASSERT_EQ(runs.size(), 2u);  // the test and its preparation
  EXPECT_TRUE(runs[0].is_preparation);
  EXPECT_EQ(runs[1].after, 0u);
  const RunStore store(folder_, "runs");
  auto lock = store.try_lock(runs[0].key);
  ASSERT_TRUE(lock);
  EXPECT_TRUE(maker_of(store.root(), runs[0].key));
  std::stop_source stop;
  RunCounts counts;
  {
    const std::jthread later([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      stop.request_stop();
    });
    EXPECT_THROW(make_runs(runs, store, {.threads = 1, .stop = stop.get_token()}, counts), Interrupted);
  }
  EXPECT_FALSE(fs::exists(store.folder(runs[0].key)));
  lock.reset();
  make_runs(runs, store, {.threads = 1}, counts);
  EXPECT_TRUE(store.find(runs[1].key));
}

}  // namespace
}  // namespace grainlaw::dem
