// What runs would take, before and after they were made.
#include "dem/runs/expected_cost.hpp"

#include <fstream>

#include "dem/runs/feasibility.hpp"
#include "dem/runs/simulation.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

class ExpectedCosts : public testing::TemporaryFolder {};

Spec small_spec() {
  return spec_from_json(
      Json{{"particles", 40},
           {"seeds", {1, 2}},
           {"strain_rate", 20000},
           {"rows", 10},
           {"nu_end", 0.7},
           {"densities", {0.74}},
           {"tests",
            {{{"mode", "ISO"}, {"role", "calibration"}}, {{"mode", "D2"}, {"strain", 0.02}, {"role", "calibration"}}}}},
      "spec");
}

TEST_F(ExpectedCosts, CountsEachRunOnceAndWhatIsFinishedNotAtAll) {
  const Spec spec = small_spec();
  const std::vector<PlannedTest> tests = plan(spec);
  ASSERT_EQ(tests.size(), 4u);
  const ExpectedCost before = expected_cost(tests, folder_);
  EXPECT_EQ(before.runs, 4u);  // two preparations, whose branch ISO is, and two tests
  EXPECT_EQ(before.found, 0u);
  double driven = 0;
  for (const PlannedTest& test : tests)
    driven += test.branch_of_preparation ? expected_work(test.preparation) : expected_work(test);
  EXPECT_GT(before.particle_steps, driven);  // relaxations besides
  EXPECT_FALSE(fs::exists(folder_ / "runs"));

  fs::create_directory(folder_ / "data");
  RunCounts counts;
  run_planned(tests, {}, folder_ / "data", RunStore(folder_, "runs"), {}, counts);
  EXPECT_EQ(counts.runs, before.runs);
  const ExpectedCost after = expected_cost(tests, folder_);
  EXPECT_EQ(after.found, 4u);
  EXPECT_EQ(after.particle_steps, 0);
  double bytes = 0;
  for (const char* part : {"runs", "data"}) {
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / part))
      bytes += entry.is_regular_file() ? static_cast<double>(entry.file_size()) : 0;
  }
  EXPECT_NEAR(after.bytes / bytes, 1, 0.3);
}

TEST_F(ExpectedCosts, OfATestAreItsPreparationAndItself) {
  std::ofstream(folder_ / "t.json") << R"({"particles": 40, "strain_rate": 20000, "rows": 10, "initial": {"nu": 0.74},
                                           "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}]})";
  const TestFile test = read_test(folder_ / "t.json");
  EXPECT_EQ(expected_cost(test, folder_).runs, 2u);
  simulate(test, folder_, {});
  EXPECT_EQ(expected_cost(test, folder_).found, 2u);
  std::ofstream(folder_ / "s.json") << R"({"state": "end.state", "strain_rate": 20000, "rows": 10,
                                           "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}]})";
  const TestFile given = read_test(folder_ / "s.json");
  EXPECT_EQ(expected_cost(given, folder_).runs, 1u);  // no preparation
  EXPECT_GE(expected_cost(given, folder_).particle_steps, expected_work(given));
  EXPECT_EQ(expected_cost(given, folder_).found, 0u);
}

TEST(MeasuredRate, IsPositiveAndStopsOnRequest) {
  PreparationOptions like;
  like.packing.particles = 60;
  EXPECT_GT(measured_rate(like, 2, {}), 1e3);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(measured_rate(like, 1, stop.get_token()), Interrupted);
}

}  // namespace
}  // namespace grainlaw::dem
