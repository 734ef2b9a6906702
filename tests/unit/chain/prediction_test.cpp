// One rung that fails must take neither the others nor runs with it; what fails altogether leaves no folder.
#include "chain/prediction.hpp"

#include <cmath>
#include <limits>

#include "model/files/output.hpp"
#include "model/files/series_csv.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/synthetic_dataset.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::chain {
namespace {

using testing::leg_to;

class PathPrediction : public testing::TemporaryFolder {
 protected:
  /// Uniaxial compression by a law whose rungs all have values; those named in `broken` fail at once, at a number that is
  /// none.
  static PredictionInput input(const std::vector<Rung>& broken) {
    PredictionInput input;
    input.law_name = "the law";
    input.path_name = "the path";
    input.law.parameters = testing::synthetic_truth();
    input.law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
    input.law.range = {};
    input.law.converged = true;
    for (std::size_t i = 0; i < kParameterCount; ++i)
      input.law.estimates[i] = {*fields(input.law.parameters)[i], std::nan(""), Status::fixed, ""};
    input.path.path = {0.72, Branch::unloading, {leg_to(Mode::UNI, 0.76)}};
    for (const Rung rung : broken) {
      auto& p = input.law.parameters;
      (rung == Rung::memory ? p.memory.k : p.anisotropy.a2) = std::numeric_limits<double>::quiet_NaN();
    }
    return input;
  }

  /// A run of the path by the law itself.
  FinishedRuns runs(const Path& path) const {
    testing::SyntheticDataset made(testing::synthetic_truth(), {});
    FinishedRuns runs{{}, folder_ / "runs"};
    std::filesystem::create_directory(runs.folder);
    runs.dataset.tests.push_back({made.test("UNI-s7", 7, path.nu, path.segments), "", "", {}, {}});
    TestRecord& record = runs.dataset.tests[0].record;
    record.role = Role::validation;
    write_series(runs.folder / "UNI-s7.csv", record.rows);
    write_dataset_index(runs.folder, runs.dataset);
    return runs;
  }

  std::filesystem::path out() const { return folder_ / "out"; }
};

TEST_F(PathPrediction, GoesOnWithoutARungThatFails) {
  PredictionInput failing = input({Rung::memory});
  failing.finished_runs = runs(failing.path.path);
  predict_path(failing, out(), {});
  const predict::PredictionFolder read = predict::read_prediction(out());
  ASSERT_EQ(read.failures.size(), 3u) << "from the law's start, and at the run's rows from both starts";
  for (const predict::FailedCurve& failed : read.failures) {
    EXPECT_EQ(failed.model, Rung::memory);
    EXPECT_NE(failed.error.find("segments[0]"), std::string::npos) << failed.error;
  }
  EXPECT_FALSE(read.failures[0].seed);
  EXPECT_EQ(read.failures[1].seed, 7u);
  ASSERT_EQ(read.curves.size(), 6u);
  for (const predict::PredictedCurve& curve : read.curves) EXPECT_NE(curve.model, Rung::memory);
  EXPECT_EQ(read.comparisons.size(), 8u) << "four curves, four means";
}

TEST_F(PathPrediction, WarnsOfARungThatFails) {
  struct : Watch {
    std::vector<std::string> lines;
    void log(const std::string& text) override { lines.push_back(text); }
  } watch;
  predict_path(input({Rung::memory}), out(), {.watch = watch});
  EXPECT_TRUE(std::any_of(watch.lines.begin(), watch.lines.end(),
                          [](const std::string& line) { return line.starts_with("warning: memory is left out: "); }));
}

TEST_F(PathPrediction, FailsWhereEveryRungFailsAndLeavesNoFolder) {
  for (const bool with_runs : {false, true}) {
    PredictionInput failing = input({Rung::memory});
    failing.model = Rung::memory;
    if (with_runs) failing.finished_runs = runs(failing.path.path);
    EXPECT_THROW(predict_path(failing, out(), {}), NotConverged);
    EXPECT_FALSE(std::filesystem::exists(out()));
  }
}

TEST_F(PathPrediction, LeavesNoFolderAfterARefusal) {
  PredictionInput refused = input({});
  FinishedRuns off = runs(refused.path.path);
  off.dataset.tests[0].record.rows[5].strain.tensor(0, 1) = 0.1;  // off the path
  refused.finished_runs = off;
  EXPECT_THROW(predict_path(refused, out(), {}), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(out()));
}

}  // namespace
}  // namespace grainlaw::chain
