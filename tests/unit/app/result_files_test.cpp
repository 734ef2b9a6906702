// Data set, parameters, calibration and prediction: written, read back equal, refused when damaged. F12.
#include <cmath>
#include <cstring>
#include <utility>

#include "model/files/digest.hpp"
#include "app/files/calibration_file.hpp"
#include "model/files/dataset.hpp"
#include "chain/parameters_file.hpp"
#include "predict/prediction_files.hpp"
#include "model/files/series_csv.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/german_locale.hpp"
#include "tests/support/synthetic_dataset.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

using testing::refusal;

Dataset small_dataset(const std::filesystem::path& folder) {
  testing::SyntheticOptions options;
  options.seeds = {1, 2};
  options.densities = {0.70, 0.74};
  options.rows = 10;
  Dataset dataset;
  for (TestRecord& record : testing::SyntheticDataset(testing::synthetic_truth(), options).records()) {
    for (std::size_t i = 0; i < record.rows.size(); ++i) record.rows[i].time = 1e-3 * static_cast<double>(i);
    write_series(folder / (record.name + ".csv"), record.rows);
    dataset.tests.push_back({record, "", std::string(64, 'a'), {1000, 1e-7, 2.5}, {"a warning"}});
  }
  dataset.seeds = options.seeds;
  dataset.spec = {{"particles", 100}};
  write_dataset_index(folder, dataset);
  return dataset;
}

/// A calibration with odd values in every field; no fit is needed to test files.
fit::Calibration odd_calibration() {
  fit::Calibration c;
  c.coupling = Coupling::single;
  c.converged = true;
  c.parameters = published_parameters();
  c.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  const auto values = fields(c.parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    *values[i] = std::nextafter(*values[i] * (1 - 1e-3 / 7), 0.0);
    c.estimates[i] = {*values[i], 0.1 / static_cast<double>(i + 3), fit::Status::fitted, i % 2 ? "a note" : "",
                      1 + 1.0 / static_cast<double>(i + 3)};
    for (std::size_t j = 0; j < kParameterCount; ++j) {
      c.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          (i == j ? 1 : 0.1) / static_cast<double>(i + j + 3);
    }
  }
  const auto drop = [&](const char* name, fit::Status status) {
    const std::size_t i = parameter_index(name);
    c.estimates[i].status = status;
    c.estimates[i].standard_error = std::nan("");
    c.estimates[i].degrees_of_freedom = std::nan("");
    c.covariance.row(static_cast<Eigen::Index>(i)).setZero();
    c.covariance.col(static_cast<Eigen::Index>(i)).setZero();
  };
  drop("anisotropy.a2", fit::Status::not_identified);
  drop("shear.nu_c", fit::Status::fixed);
  c.scatter = {3, 22, 1.0 / 700, 1.0 / 60, std::nan("")};
  c.nu_min = 0.1 + 0.2;
  c.nu_max = 0.82;
  c.eps_dev_max = 1.0 / 3;
  c.eps_vol_max = 0.2;
  fit::Stage stage;
  stage.name = "coordination";
  stage.window = "nu >= 0.675";
  stage.residuals = 7;
  stage.final_cost = 1.0 / 3;
  stage.termination = "CONVERGENCE: \"quoted\"";
  stage.converged = true;
  stage.tests.push_back({"D2-0.70-s1", "s_par", false, 5, 2, 3, 0.1, -0.2, std::nan("")});
  stage.estimates.push_back({"coordination.C1", c.estimates[0]});
  stage.starts = {5, 3, 0.7};
  stage.profiles.push_back(
      {"coordination.C1", "at its bound", 0.5, std::nan(""), {{0.5, 1}, {0.7, std::nan("")}}, "more of it"});
  c.stages.push_back(stage);
  fit::ShearFit shear;
  shear.test = "D2-0.70-s1";
  shear.mode = Mode::D3;
  shear.seed = 4;
  shear.nu = 0.7;
  shear.s_max = c.estimates[3];
  shear.P_star = std::nan("");
  shear.steady_from = 0.15;
  shear.steady_since_F = 0.08;
  shear.steady_since_s = std::nan("");
  c.shear.push_back(shear);
  c.left_out.push_back({7, std::vector<double>(kParameterCount, 1.0 / 7), ""});
  c.left_out.push_back({9, std::vector<double>(kParameterCount, 1.0 / 9), "did not converge"});
  c.unused_tests = {"ISO-loading-s1"};
  c.warnings = {"test D2-0.70-s1: 1 of 61 rows of s_par stand out"};
  return c;
}

class ResultFiles : public testing::TemporaryFolder {};

TEST_F(ResultFiles, DatasetIsReadBack) {
  const Dataset written = small_dataset(folder_);
  const Dataset read = read_dataset(folder_);
  EXPECT_EQ(read.digest, written.digest);
  EXPECT_EQ(read.spec, written.spec);
  EXPECT_EQ(read.seeds, written.seeds);
  ASSERT_EQ(read.tests.size(), written.tests.size());
  for (std::size_t i = 0; i < read.tests.size(); ++i) {
    const DatasetTest &a = read.tests[i], &b = written.tests[i];
    EXPECT_EQ(a.record.name, b.record.name);
    EXPECT_EQ(a.record.role, b.record.role);
    EXPECT_EQ(a.record.packing.mean_radius, b.record.packing.mean_radius);
    EXPECT_EQ(series_text(a.record.rows), series_text(b.record.rows));
    EXPECT_EQ(a.sha256, sha256_of_file(folder_ / (a.record.name + ".csv")));
    EXPECT_EQ(a.cost.steps, 1000u);
    EXPECT_EQ(a.warnings, std::vector<std::string>{"a warning"});
  }
}

TEST_F(ResultFiles, DatasetOfOthersNeedsLittle) {
  const Dataset written = small_dataset(folder_);
  Json index = read_json(folder_ / "dataset.json", JsonSource::own);
  Json tests = Json::array();
  for (const Json& test : index["tests"]) {
    tests.push_back({{"name", test["name"]},
                     {"role", test["role"]},
                     {"path", test["path"]},
                     {"packing",
                      {{"seed", test["packing"]["seed"]},
                       {"mean_radius", test["packing"]["mean_radius"]},
                       {"stiffness", test["packing"]["stiffness"]}}}});
  }
  write_json(folder_ / "dataset.json", {{"tests", tests}});
  const Dataset read = read_dataset(folder_);
  EXPECT_EQ(read.tests.size(), written.tests.size());
  EXPECT_EQ(read.seeds, written.seeds);
  EXPECT_TRUE(read.spec.is_null());
}

TEST_F(ResultFiles, DamagedDatasetIsRefused) {
  const Dataset written = small_dataset(folder_);
  const auto csv = folder_ / (written.tests[1].record.name + ".csv");
  const std::string good = content(csv), index = content(folder_ / "dataset.json");
  const auto message = [&] { return refusal([&] { read_dataset(folder_); }); };
  put(csv.filename(), good + good.substr(good.find_last_of('\n', good.size() - 2) + 1));  // a row twice
  EXPECT_NE(message().find(csv.filename().string()), std::string::npos) << message();
  std::string truncated = good;
  truncated.erase(truncated.find_last_of('\n', truncated.size() - 2) + 1);
  put(csv.filename(), truncated);
  EXPECT_NE(message().find("SHA-256 differs"), std::string::npos) << message();
  std::filesystem::remove(csv);
  EXPECT_NE(message().find("cannot be opened"), std::string::npos) << message();
  put(csv.filename(), good);
  std::string edited = index;
  edited.replace(edited.find("\"calibration\""), 13, "\"validation\"");  // a role cannot be changed unseen
  put("dataset.json", edited);
  EXPECT_NE(message().find("digest: does not match"), std::string::npos) << message();
  edited = index;
  edited.replace(edited.find(written.tests[1].record.name), written.tests[1].record.name.size(), "../../x");
  put("dataset.json", edited);
  EXPECT_NE(message().find("tests[1].name: got \"../../x\""), std::string::npos) << message();
}

void expect_same(const fit::Calibration& a, const fit::Calibration& b) {
  const auto x = fields(a.parameters), y = fields(b.parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    EXPECT_EQ(a.estimates[i].status, b.estimates[i].status);
    EXPECT_EQ(a.estimates[i].note, b.estimates[i].note);
    if (a.estimates[i].status == fit::Status::not_identified) continue;
    EXPECT_EQ(std::memcmp(x[i], y[i], sizeof(double)), 0) << parameter_table()[i].name;
    if (!std::isnan(a.estimates[i].standard_error)) {
      EXPECT_EQ(a.estimates[i].standard_error, b.estimates[i].standard_error);
      EXPECT_EQ(a.estimates[i].degrees_of_freedom, b.estimates[i].degrees_of_freedom);
    }
  }
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.scatter.packings, b.scatter.packings);
  EXPECT_EQ(a.scatter.degrees_of_freedom, b.scatter.degrees_of_freedom);
  EXPECT_EQ(a.scatter.compression, b.scatter.compression);
  EXPECT_EQ(a.scatter.s_par, b.scatter.s_par);
  EXPECT_EQ(std::isnan(a.scatter.F_par), std::isnan(b.scatter.F_par));
  EXPECT_EQ(a.coupling, b.coupling);
  EXPECT_EQ(a.nu_min, b.nu_min);
  EXPECT_EQ(a.nu_max, b.nu_max);
  EXPECT_EQ(a.eps_dev_max, b.eps_dev_max);
  EXPECT_EQ(a.eps_vol_max, b.eps_vol_max);
}

TEST_F(ResultFiles, ParametersAreReadBackBitForBit) {
  const fit::Calibration c = odd_calibration();
  chain::write_parameters(folder_ / "parameters.json", {c, std::string(64, 'b'), {{"command", "test"}}});
  const chain::ParametersFile read = chain::read_parameters(folder_ / "parameters.json");
  expect_same(c, read.calibration);
  EXPECT_EQ(read.dataset_digest, std::string(64, 'b'));
  const Json file = read_json(folder_ / "parameters.json", JsonSource::own);
  EXPECT_TRUE(file["parameters"]["anisotropy.a2"]["value"].is_null());
  EXPECT_TRUE(file["parameters"]["shear.nu_c"]["standard_error"].is_null());
}

/// A locale whose numbers look like "1.234,5".
// Hard case F12.
TEST_F(ResultFiles, F12DoNotDependOnTheLocale) {
  const fit::Calibration c = odd_calibration();
  chain::write_parameters(folder_ / "plain.json", {c, "", {}});
  chain::ParametersFile read;
  Dataset written, dataset;
  {
    const testing::GermanLocale german(folder_);
    if (!german.in_c()) GTEST_LOG_(INFO) << "no German locale could be made; only the C++ locale was changed";
    chain::write_parameters(folder_ / "german.json", {c, "", {}});
    read = chain::read_parameters(folder_ / "plain.json");
    written = small_dataset(folder_);
    dataset = read_dataset(folder_);
  }
  const std::string plain = content(folder_ / "plain.json"), german = content(folder_ / "german.json");
  ASSERT_EQ(plain.size(), german.size());
  int differing = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) differing += plain[i] != german[i] ? 1 : 0;
  testing::expect_figure("F12.differing_characters_of_parameters", differing, 0);
  differing = 0;
  const auto written_fields = fields(c.parameters), read_fields = fields(std::as_const(read).calibration.parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const bool has_value = c.estimates[i].status != fit::Status::not_identified;
    if (has_value && std::memcmp(written_fields[i], read_fields[i], sizeof(double)) != 0) ++differing;
  }
  testing::expect_figure("F12.differing_doubles_read_back", differing, 0);
  EXPECT_EQ(dataset.digest, written.digest);
  expect_same(c, read.calibration);
}

TEST_F(ResultFiles, DoubtfulParametersAreRefused) {
  chain::write_parameters(folder_ / "p.json", {odd_calibration(), "", {}});
  const Json good = read_json(folder_ / "p.json", JsonSource::own);
  const auto message = [&](const std::function<void(Json&)>& damage) {
    Json bad = good;
    damage(bad);
    write_json(folder_ / "bad.json", OrderedJson(bad));
    return refusal([&] { chain::read_parameters(folder_ / "bad.json"); });
  };
  EXPECT_NE(message([](Json& j) {
              j["parameters"]["pressure.p0"]["value"] = nullptr;
            }).find("bad.json: parameters.pressure.p0.value: must be null exactly"),
            std::string::npos);
  EXPECT_NE(message([](Json& j) {
              j["parameters"]["pressure.p0"]["value"] = -3;
            }).find("parameters.pressure.p0.value: -3 is outside its bounds"),
            std::string::npos);
  EXPECT_NE(message([](Json& j) {
              j["parameters"]["pressure.p1"] = j["parameters"]["pressure.p0"];
            }).find("'pressure.p1' is no parameter"),
            std::string::npos);
  EXPECT_NE(message([](Json& j) { j["parameters"]["pressure.p0"]["status"] = "sure"; }).find("got \"sure\""),
            std::string::npos);
  EXPECT_NE(message([](Json& j) { j["covariance"]["matrix"].erase(0); }).find("covariance.matrix: needs one row"),
            std::string::npos);
  EXPECT_NE(message([](Json& j) { j["ranges"]["nu"] = {0.7}; }).find("ranges.nu"), std::string::npos);
  EXPECT_NE(message([](Json& j) { j.erase("coupling"); }).find("misses the key 'coupling'"), std::string::npos);

  const chain::ParametersFile read = chain::read_parameters(folder_ / "p.json");
  EXPECT_EQ(refusal([&] { chain::require_parameters(read, Rung::evolution, "p.json"); }),
            "accepted");  // single coupling reads a0
  chain::ParametersFile energy = read;
  energy.calibration.coupling = Coupling::energy;
  EXPECT_NE(refusal([&] {
              chain::require_parameters(energy, Rung::evolution, "p.json");
            }).find("p.json: parameters.anisotropy.a2: is not identified"),
            std::string::npos);
  EXPECT_EQ(refusal([&] { chain::require_parameters(energy, Rung::reduced, "p.json"); }), "accepted");
  energy.calibration.estimates[parameter_index("stress_rate.alpha")].status = fit::Status::not_identified;
  EXPECT_NE(refusal([&] { chain::require_parameters(energy, Rung::reduced, "p.json"); }).find("stress_rate.alpha"),
            std::string::npos);
  energy.calibration.parameters.stress_rate.Q_c = 0;  // the exponential is gone, and its decay with it
  EXPECT_EQ(refusal([&] { chain::require_parameters(energy, Rung::reduced, "p.json"); }), "accepted");
}

TEST_F(ResultFiles, CalibrationIsReadBack) {
  const fit::Calibration c = odd_calibration();
  write_calibration(folder_ / "calibration.json", c, {}, {}, std::string(64, 'c'), {{"command", "test"}});
  fit::Calibration read;
  read_calibration(folder_ / "calibration.json", read);
  ASSERT_EQ(read.stages.size(), 1u);
  EXPECT_EQ(read.stages[0].window, c.stages[0].window);
  EXPECT_EQ(read.stages[0].final_cost, c.stages[0].final_cost);
  EXPECT_EQ(read.stages[0].tests[0].rms, 0.1);
  EXPECT_FALSE(read.stages[0].tests[0].in_cost);
  EXPECT_TRUE(std::isnan(read.stages[0].tests[0].max_abs_data));
  EXPECT_EQ(read.stages[0].estimates[0].name, "coordination.C1");
  ASSERT_EQ(read.shear.size(), 1u);
  EXPECT_EQ(read.shear[0].mode, Mode::D3);
  EXPECT_EQ(read.shear[0].s_max.value, c.estimates[3].value);
  EXPECT_TRUE(std::isnan(read.shear[0].P_star));
  EXPECT_EQ(read.shear[0].steady_from, 0.15);
  EXPECT_EQ(read.shear[0].steady_since_F, 0.08);
  EXPECT_TRUE(std::isnan(read.shear[0].steady_since_s));
  EXPECT_EQ(read.stages[0].tests[0].rows_lightened, 3);
  EXPECT_EQ(read.stages[0].starts.tried, 5);
  EXPECT_EQ(read.stages[0].starts.at_minimum, 3);
  EXPECT_EQ(read.stages[0].starts.next_cost, 0.7);
  ASSERT_EQ(read.stages[0].profiles.size(), 1u);
  const fit::Profile& profile = read.stages[0].profiles[0];
  EXPECT_EQ(profile.parameter, "coordination.C1");
  EXPECT_EQ(profile.reason, "at its bound");
  EXPECT_EQ(profile.lower, 0.5);
  EXPECT_TRUE(std::isnan(profile.upper));
  ASSERT_EQ(profile.points.size(), 2u);
  EXPECT_EQ(profile.points[0].excess, 1);
  EXPECT_TRUE(std::isnan(profile.points[1].excess));
  EXPECT_EQ(profile.experiment, "more of it");
  ASSERT_EQ(read.left_out.size(), 2u);
  EXPECT_EQ(read.left_out[1].seed, 9u);
  EXPECT_EQ(read.left_out[1].note, "did not converge");
  EXPECT_EQ(read.left_out[1].value[0], 1.0 / 9);
  EXPECT_TRUE(std::isnan(read.left_out[1].value[parameter_index("shear.nu_c")])) << "has no error to compare with";
  EXPECT_EQ(read.unused_tests, c.unused_tests);
  EXPECT_EQ(read.warnings, c.warnings);
  EXPECT_NE(refusal([&] { read_calibration(put("old.json", "{}"), read); }).find("run grainlaw calibrate again"),
            std::string::npos);
}

predict::PredictionFolder small_prediction(const std::filesystem::path& folder) {
  std::filesystem::create_directory(folder / "dem");
  predict::PredictionFolder content;
  content.dem = small_dataset(folder / "dem");
  const TestRecord& test = content.dem->tests[1].record;
  content.path = test.path;
  const auto segments = resolve(test.path);
  const auto law = testing::synthetic_truth();
  for (const std::uint64_t seed : {3u, 4u}) {
    predict::PredictedCurve curve{Rung::evolution, predict::Initial::measured, seed, fmt::format("evolution-measured-s{}.csv", seed), {}};
    curve.prediction =
        predict::predict(curve.model, law, Coupling::energy, segments, predict::state_from_law(law, test.path.nu),
                         predict::points_of(test), {}, {}, {});
    curve.prediction.warnings = {"outside"};
    content.comparisons.push_back({curve.model, curve.initial, seed, predict::compare(curve.prediction, test)});
    content.curves.push_back(curve);
  }
  content.needed = {Rung::memory, "because"};
  content.changes = {{Rung::reduced, Rung::evolution, {0.1, 0.02, 0.003}}};
  content.bands = "of the mean curve";
  content.curves[0].prediction.rows[1].single.s_dev = 0.0123;
  content.comparisons[1].comparison.quantities[0].bias = 0.5;
  content.comparisons[1].comparison.quantities[0].coverage_single = 0.93;
  content.comparisons[1].comparison.quantities[0].largest = -2;
  content.comparisons[1].comparison.quantities[0].largest_at_nu = 0.71;
  return content;
}

TEST_F(ResultFiles, PredictionIsReadBack) {
  const predict::PredictionFolder written = small_prediction(folder_);
  predict::write_prediction(folder_, written);
  const predict::PredictionFolder read = predict::read_prediction(folder_);
  ASSERT_EQ(read.curves.size(), 2u);
  EXPECT_EQ(read.curves[1].seed, 4u);
  EXPECT_EQ(read.curves[1].initial, predict::Initial::measured);
  EXPECT_EQ(read.curves[1].prediction.statistics.steps, written.curves[1].prediction.statistics.steps);
  EXPECT_EQ(read.curves[1].prediction.warnings, std::vector<std::string>{"outside"});
  ASSERT_EQ(read.curves[0].prediction.rows.size(), written.curves[0].prediction.rows.size());
  ASSERT_EQ(read.comparisons.size(), written.comparisons.size());
  EXPECT_EQ(read.comparisons[1].comparison.quantities[0].bias, 0.5);
  EXPECT_EQ(read.comparisons[1].comparison.quantities[0].coverage_single, 0.93);
  EXPECT_TRUE(std::isnan(read.comparisons[1].comparison.quantities[0].coverage_mean));
  EXPECT_EQ(read.curves[0].prediction.rows[1].single.s_dev, 0.0123);
  EXPECT_TRUE(std::isnan(read.curves[0].prediction.rows[1].mean.s_dev)) << "no band";
  EXPECT_EQ(read.needed.rung, Rung::memory);
  EXPECT_EQ(read.needed.why, "because");
  ASSERT_EQ(read.changes.size(), 1u);
  EXPECT_EQ(read.changes[0].richer, Rung::evolution);
  EXPECT_EQ(read.changes[0].difference.F, 0.003);
  EXPECT_EQ(read.bands, "of the mean curve");
  ASSERT_TRUE(read.dem);
  EXPECT_EQ(read.dem->digest, written.dem->digest);
  std::filesystem::remove(folder_ / "comparison.json");
  EXPECT_NE(refusal([&] { predict::read_prediction(folder_); }).find("comparison.json"), std::string::npos);
}

TEST_F(ResultFiles, MeanOverSeedsIsTheMeanAndKeepsTheLargest) {
  const predict::PredictionFolder content = small_prediction(folder_);
  const auto means = predict::mean_over_seeds(content.comparisons);
  ASSERT_EQ(means.size(), 1u);
  const auto &a = content.comparisons[0].comparison.quantities[0], &b = content.comparisons[1].comparison.quantities[0];
  const auto& mean = means[0].comparison.quantities[0];
  EXPECT_FALSE(means[0].seed);
  EXPECT_EQ(mean.quantity, a.quantity);
  EXPECT_DOUBLE_EQ(mean.bias, (a.bias + b.bias) / 2);
  EXPECT_DOUBLE_EQ(mean.normalised_rms, (a.normalised_rms + b.normalised_rms) / 2);
  EXPECT_EQ(mean.rows, a.rows + b.rows);
  EXPECT_EQ(mean.largest, -2);
  EXPECT_EQ(mean.largest_at_nu, 0.71);
}

}  // namespace
}  // namespace grainlaw::app
