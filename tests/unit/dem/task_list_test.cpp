// Runs dealt out to tasks: each once, of like work, written and read again, done in any order.
#include "dem/runs/task_list.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/expected_cost.hpp"
#include "model/files/output.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

Spec spec_of(const std::string& more) {
  return spec_from_json(parse_json(R"({"particles": 32, "strain_rate": 20000, "rows": 20, "nu_end": 0.70, "tests": [
      {"mode": "ISO", "role": "calibration"}, {"mode": "D2", "strain": 0.02, "role": "calibration"}], )" +
                                       more + "}",
                                   "s.json", JsonSource::user),
                        "s.json");
}

class TaskLists : public testing::TemporaryFolder {
 protected:
  void look_at(const std::string& spec) {
    planned_ = plan(spec_of(spec));
    runs_ = runs_of(planned_);
    list_ = listed(runs_);
  }
  std::vector<PlannedTest> planned_;
  std::vector<PlannedRun> runs_;
  std::vector<ListedRun> list_;
};

TEST_F(TaskLists, ListEachRunLongestFirst) {
  look_at(R"("seeds": [1, 2, 3], "densities": [0.72, 0.74, 0.76])");
  ASSERT_EQ(list_.size(), 12u);  // 3 preparations, whose branch ISO is, and 9 tests
  for (std::size_t i = 1; i < list_.size(); ++i) EXPECT_GE(list_[i - 1].particle_steps, list_[i].particle_steps);
  double sum = 0;
  std::set<std::string> keys;
  for (const ListedRun& run : list_) {
    sum += run.particle_steps;
    keys.insert(run.key);
    EXPECT_EQ(run.preparation.empty(), run.name.starts_with("preparation-s")) << run.name;
  }
  EXPECT_EQ(keys.size(), 12u);
  EXPECT_NEAR(sum, expected_cost(planned_, folder_).particle_steps, 1e-9 * sum);
}

TEST_F(TaskLists, AreDealtOutInLikeShares) {
  for (const char* spec : {R"("seeds": [1, 2, 3, 4, 5], "densities": [0.72, 0.74, 0.76, 0.78, 0.8])",
                           R"("seeds": [1], "densities": [0.72, 0.73, 0.74, 0.75, 0.76, 0.77, 0.78, 0.79, 0.8])"}) {
    for (const int tasks : {1, 2, 3, 8, 1000}) {
      look_at(spec);
      const double longest = list_.front().particle_steps;
      deal(list_, tasks);
      std::map<int, double> load;
      std::set<std::string> keys;
      std::map<int, bool> tests_begun;
      for (const ListedRun& run : list_) {
        load[run.task] += run.particle_steps;
        keys.insert(run.key);
        EXPECT_FALSE(run.preparation.empty() && tests_begun[run.task]) << "preparations come first";
        if (!run.preparation.empty()) tests_begun[run.task] = true;
      }
      EXPECT_EQ(keys.size(), runs_.size());
      EXPECT_EQ(load.size(), std::min(static_cast<std::size_t>(tasks), runs_.size()));
      EXPECT_EQ(load.begin()->first, 1);
      double least = longest * 1e9, most = 0;
      for (const auto& [task, work] : load) least = std::min(least, work), most = std::max(most, work);
      EXPECT_LE(most - least, longest * (1 + 1e-12)) << spec << " " << tasks;
      // nobody has more than its share and one run
      EXPECT_LE(most, expected_cost(planned_, folder_).particle_steps / static_cast<double>(load.size()) + longest);
    }
  }
}

TEST_F(TaskLists, KeepTestsWithTheirPreparation) {
  look_at(R"("seeds": [1, 2, 3, 4], "densities": [0.72, 0.74])");
  deal(list_, 4);
  std::map<std::string, int> task_of;
  for (const ListedRun& run : list_) task_of[run.key] = run.task;
  for (const ListedRun& run : list_) {
    if (run.preparation.empty()) continue;
    EXPECT_EQ(run.task, task_of[run.preparation]) << run.name;
  }
}

TEST_F(TaskLists, AreReadAsWritten) {
  const Spec spec = spec_of(R"("seeds": [1, 2], "densities": [0.74])");
  look_at(R"("seeds": [1, 2], "densities": [0.74])");
  deal(list_, 2);
  EXPECT_EQ(write_tasks(spec, 2, folder_, {}).runs.size(), 4u);
  const TaskList read = read_tasks(folder_);
  EXPECT_EQ(spec_to_json(read.spec), spec_to_json(spec));
  ASSERT_EQ(read.runs.size(), list_.size());
  for (std::size_t i = 0; i < list_.size(); ++i) {
    EXPECT_EQ(read.runs[i].key, list_[i].key);
    EXPECT_EQ(read.runs[i].task, list_[i].task);
    EXPECT_EQ(read.runs[i].particle_steps, list_[i].particle_steps);
  }
  put("tasks/tasks.json", R"({"runs": [{"task": -1e300}]})");
  EXPECT_NE(testing::refusal([&] { read_tasks(folder_); }).find("tasks.json: "), std::string::npos);
  fs::remove(folder_ / "tasks" / "tasks.json");
  EXPECT_NE(testing::refusal([&] { read_tasks(folder_); }).find("grainlaw runs SPEC -o"), std::string::npos);
}

TEST_F(TaskLists, AreDoneByTaskNameAndKey) {
  const Spec spec = spec_of(R"("seeds": [1, 2], "densities": [0.74])");
  look_at(R"("seeds": [1, 2], "densities": [0.74])");
  deal(list_, 2);
  const TaskList list{spec, list_};
  const auto finished = [&](const std::string& name) {
    const auto run = std::find_if(runs_.begin(), runs_.end(), [&](const PlannedRun& r) { return r.name == name; });
    return is_finished(folder_ / "runs", run->key);
  };
  EXPECT_EQ(make_tasks(list, {"D2-0.74-s2"}, folder_, {}).runs, 2u);  // with its preparation
  EXPECT_TRUE(finished("D2-0.74-s2") && finished("preparation-s2"));
  EXPECT_FALSE(finished("D2-0.74-s1"));
  const RunCounts by_key = make_tasks(list, {runs_.front().key.substr(0, 8)}, folder_, {});
  EXPECT_EQ(by_key.runs, 1u);
  EXPECT_TRUE(finished(runs_.front().name));
  EXPECT_EQ(write_tasks(spec, 2, folder_, {}).runs.size(), 1u);  // what is missing
  const RunCounts all = make_tasks(list, {"1", "2"}, folder_, {});
  EXPECT_EQ(all.runs, 4u);
  EXPECT_EQ(all.found, 3u);
  for (const char* none : {"3", "0", "D2", "", "ffffffff", "-1"})
    EXPECT_NE(testing::refusal([&] { make_tasks(list, {none}, folder_, {}); }).find("has no task"), std::string::npos)
        << none;
  TaskList of_another_version = list;
  of_another_version.runs.front().key.replace(0, 4, "zzzz");
  EXPECT_NE(testing::refusal([&] { make_tasks(of_another_version, {"1"}, folder_, {}); }).find("write it anew"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::dem
