// One rung that fails must take neither the others nor runs with it; what fails altogether leaves no folder.
#include "chain/prediction.hpp"

#include <cmath>
#include <limits>

#include "model/files/output.hpp"
#include "model/files/series_csv.hpp"
#include "predict/rehearse.hpp"
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
    input.law_file = "the law";
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

TEST_F(PathPrediction, RecommendsNoRungThatFailedWhereTheLawDecidesTheStrain) {
  PredictionInput failing = input({Rung::memory});
  failing.path.path.segments = {{Mode::D2, direction_of(Mode::D2), ExtentKind::target_stress_ratio, 0.1}};
  const predict::PredictionFolder found = predict_path(failing, out(), {});
  ASSERT_EQ(found.failures.size(), 1u);
  EXPECT_EQ(found.failures[0].model, Rung::memory);
  EXPECT_EQ(found.recommended.rung, Rung::evolution);
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

TEST_F(PathPrediction, WarnsOfABranchThatTheLawDoesNotKnow) {
  PredictionInput loading = input({});
  EXPECT_TRUE(predict_path(loading, out(), {}).warnings.empty());
  loading.path.path.branch = Branch::loading;
  const auto warnings = predict_path(loading, out(), {}).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(warnings[0].starts_with("initial.branch \"loading\"")) << warnings[0];
}

TEST_F(PathPrediction, WarnsOfSpin) {
  PredictionInput spinning = input({});
  spinning.path.path.segments[0].spin << 0, -1, 0, 1, 0, 0, 0, 0, 0;
  const auto warnings = predict_path(spinning, out(), {}).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(warnings[0].starts_with("the path spins")) << warnings[0];
}

// Isotropic compression and shear at constant volume alone, as the paper's own calibration, do not tell A2.
TEST_F(PathPrediction, LeavesOutRungsThatTheDataDoNotTell) {
  PredictionInput poor = input({});
  const auto forget = [&](const char* name) {
    const std::size_t i = parameter_index(name);
    *fields(poor.law.parameters)[i] = std::nan("");
    poor.law.estimates[i] = {std::nan(""), std::nan(""), Status::not_identified, "add a test"};
  };
  forget("memory.k");
  predict::PredictionFolder content = predict_path(poor, out(), {});
  EXPECT_EQ(content.curves.size(), 2u);
  EXPECT_EQ(content.warnings,
            std::vector<std::string>{"memory left out: parameters.memory.k is not identified: add a test"});
  forget("anisotropy.a2");
  content = predict_path(poor, out(), {});
  ASSERT_EQ(content.curves.size(), 1u);
  EXPECT_EQ(content.curves[0].model, Rung::reduced);
  EXPECT_EQ(content.warnings,
            (std::vector<std::string>{"evolution left out: parameters.anisotropy.a2 is not identified: add a test",
                                      "memory left out: parameters.memory.k is not identified: add a test"}));
  poor.model = Rung::evolution;
  EXPECT_THROW(predict_path(poor, out(), {}), InvalidInput);
  poor.model.reset();
  poor.path.path.segments[0].extent_kind = ExtentKind::target_stress_ratio;
  EXPECT_THROW(predict_path(poor, out(), {}), InvalidInput) << "a closed form of the strain is none where that is free";
}

TEST_F(PathPrediction, LabelsAPathOutsideRehearsals) {
  PredictionInput rehearsed = input({});
  const Path other{0.73, Branch::unloading, {leg_to(Mode::UNI, 0.79)}};
  predict::RehearsalRuns runs_of_other{"other", {runs(other).dataset.tests[0].record}, false};
  std::vector<std::string> failures;
  rehearsed.law.rehearsals = {
      predict::rehearsal_of(rehearsed.law, {Rung::reduced, Rung::evolution}, runs_of_other, {}, failures)};
  EXPECT_TRUE(failures.empty());
  predict_path(rehearsed, out(), {});
  const predict::PredictionFolder read = predict::read_prediction(out());
  ASSERT_TRUE(read.rehearsals);
  EXPECT_EQ(read.rehearsals->paths, 1);
  EXPECT_EQ(read.rehearsals->whole_curve_probability, 0.5);
  ASSERT_EQ(read.rehearsals->outside.size(), 1u) << "the density; the strain is shorter";
  EXPECT_TRUE(read.warnings.at(0).starts_with("outside rehearsals: nu down to 0.72 (rehearsed: 0.73)"));
  // the runs follow evolution exactly, so it is best; memory was not rehearsed
  EXPECT_LT(rehearsed.law.rehearsals[0].rungs[1].s_par.square, 1e-12);
  EXPECT_GT(rehearsed.law.rehearsals[0].rungs[0].s_par.square, 1e-6);
  rehearsed.model = Rung::evolution;
  EXPECT_TRUE(predict_path(rehearsed, out(), {}).recommended.rehearsed);
}

// A law that was fitted to width 3 is not judged by spheres of one size, nor by the packings that it was fitted to.
TEST_F(PathPrediction, RunsAreOfTheMaterialAndOfOtherPackings) {
  const PredictionInput plain = input({});
  FinishedRuns judges = runs(plain.path.path);
  Dataset fitted = judges.dataset;
  TestRecord& record = fitted.tests[0].record;
  record.role = Role::calibration;
  record.packing.seed = 31;
  record.packing.particles = 500;
  record.rows.pop_back();
  PredictionInput known = plain;
  known.law_file = folder_ / "parameters.json";
  const std::filesystem::path beside = make_subfolder(folder_, "dataset");
  write_series(beside / "UNI-s7.csv", record.rows);
  write_dataset_index(beside, fitted);

  dem::Spec spec;
  spec.preparation.packing.particles = 500;
  spec.preparation.packing.size_width = record.packing.size_width;
  EXPECT_EQ(new_runs(known, spec, {4}, "").fitted, std::vector<std::uint64_t>{31});
  EXPECT_EQ(new_runs(known, spec, {4}, "").store, folder_);
  spec.preparation.packing.particles = 501;
  EXPECT_EQ(new_runs(known, spec, {4}, "").fitted.size(), 0u) << "of another packing by the same seed";
  EXPECT_EQ(testing::refusal([&] { finished_runs(known, judges.folder); }), "accepted");

  spec.preparation.packing.size_width = 1.5;
  const std::string of_spec = testing::refusal([&] { new_runs(known, spec, {4}, ""); });
  EXPECT_NE(of_spec.find("SPEC of new runs: size_width of its packing: 1.5, but 3 in test UNI-s7"), std::string::npos)
      << of_spec;
  EXPECT_EQ(testing::refusal([&] { new_runs(plain, spec, {4}, ""); }), "accepted") << "nobody knows";
  judges.dataset.tests[0].record.packing.contacts.friction = 0.5;
  write_dataset_index(judges.folder, judges.dataset);
  const std::string of_runs = testing::refusal([&] { finished_runs(known, judges.folder); });
  EXPECT_NE(of_runs.find("test UNI-s7: contacts of its packing: hooke, friction 0.5"), std::string::npos) << of_runs;
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
