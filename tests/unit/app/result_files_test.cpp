// Data set and prediction: written, read back equal, refused when damaged. F12, with the parameters.
#include <cmath>
#include <cstring>
#include <utility>

#include "model/files/dataset.hpp"
#include "model/files/digest.hpp"
#include "model/files/output.hpp"
#include "model/files/series_csv.hpp"
#include "model/parameters_file.hpp"
#include "predict/prediction_files.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/german_locale.hpp"
#include "tests/support/odd_law.hpp"
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

// What was fitted cannot judge the law, under whatever name.
TEST_F(ResultFiles, ASeriesIsNotBothFittedAndJudged) {
  Dataset dataset = small_dataset(folder_);
  DatasetTest again = dataset.tests[1];
  ASSERT_EQ(again.record.role, Role::calibration);
  again.record.name = "again";
  write_series(folder_ / "again.csv", again.record.rows);
  dataset.tests.push_back(again);
  for (const Role role : {Role::validation, Role::rehearsal, Role::description}) {
    dataset.tests.back().record.role = role;
    write_dataset_index(folder_, dataset);
    const std::string said = refusal([&] { read_dataset(folder_); });
    if (role == Role::description) {
      EXPECT_EQ(said, "accepted") << "by laws of its own";
    } else {
      EXPECT_NE(said.find(fmt::format("test again ({}) holds the series of test {}, which is fitted", to_string(role),
                                      dataset.tests[1].record.name)),
                std::string::npos)
          << said;
    }
  }
}

// Nor does another material.
TEST_F(ResultFiles, AJudgeIsOfTheFittedMaterial) {
  Dataset dataset = small_dataset(folder_);
  DatasetTest& judge = dataset.tests[1];
  judge.record.role = Role::validation;
  const auto said = [&] {
    write_dataset_index(folder_, dataset);
    return refusal([&] { read_dataset(folder_); });
  };
  judge.record.packing.particles *= 2;
  EXPECT_EQ(said(), "accepted") << "more of the same";
  judge.record.packing.size_width = 0;
  EXPECT_EQ(said(), "accepted") << "unknown";
  judge.record.packing.size_width = 1;
  EXPECT_NE(said().find(fmt::format("test {}: size_width of its packing: 1, but 3 in test {}, which is fitted",
                                    judge.record.name, dataset.tests[0].record.name)),
            std::string::npos)
      << said();
  judge.record.role = Role::description;
  EXPECT_EQ(said(), "accepted") << "by laws of its own";
  judge.record.role = Role::rehearsal;
  judge.record.packing.size_width = 3;
  judge.record.packing.contacts.friction = 0.5;
  EXPECT_NE(said().find("friction 0.5"), std::string::npos) << said();
}

TEST_F(ResultFiles, ADataSetBesideALawIsTheFittedOneByItsDigest) {
  const Dataset dataset = small_dataset(make_subfolder(folder_, "dataset"));
  const std::filesystem::path parameters = folder_ / "parameters.json";
  EXPECT_TRUE(fitted_dataset(parameters, dataset.digest));
  EXPECT_TRUE(fitted_dataset(parameters, "")) << "of a law that does not know";
  EXPECT_FALSE(fitted_dataset(parameters, std::string(64, 'b'))) << "a law that was moved beside another data set";
  std::filesystem::remove_all(folder_ / "dataset");
  EXPECT_FALSE(fitted_dataset(parameters, dataset.digest));
}

/// A locale whose numbers look like "1.234,5".
// Hard case F12.
TEST_F(ResultFiles, F12DoNotDependOnTheLocale) {
  const CalibratedLaw c = testing::odd_law();
  write_parameters(folder_ / "plain.json", {c, {}});
  ParametersFile read;
  Dataset written, dataset;
  {
    const testing::GermanLocale german(folder_);
    if (!german.in_c()) GTEST_LOG_(INFO) << "no German locale could be made; only the C++ locale was changed";
    write_parameters(folder_ / "german.json", {c, {}});
    read = read_parameters(folder_ / "plain.json");
    written = small_dataset(folder_);
    dataset = read_dataset(folder_);
  }
  const std::string plain = content(folder_ / "plain.json"), german = content(folder_ / "german.json");
  ASSERT_EQ(plain.size(), german.size());
  int differing = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) differing += plain[i] != german[i] ? 1 : 0;
  testing::expect_figure("F12.differing_characters_of_parameters", differing, 0);
  differing = 0;
  const auto written_fields = fields(c.parameters), read_fields = fields(std::as_const(read).law.parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const bool has_value = c.estimates[i].status != Status::not_identified;
    if (has_value && std::memcmp(written_fields[i], read_fields[i], sizeof(double)) != 0) ++differing;
  }
  testing::expect_figure("F12.differing_doubles_read_back", differing, 0);
  EXPECT_EQ(dataset.digest, written.digest);
  testing::expect_same(c, read.law);
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
    predict::PredictedCurve curve{
        Rung::evolution, predict::Initial::measured, seed, fmt::format("evolution-measured-s{}.csv", seed), {}};
    curve.prediction =
        predict::predict(curve.model, law, Coupling::energy, segments, predict::state_from_law(law, test.path.nu),
                         predict::points_of(test), {}, {}, {});
    curve.prediction.warnings = {"outside"};
    content.comparisons.push_back({curve.model, curve.initial, seed, predict::compare(curve.prediction, test)});
    content.curves.push_back(curve);
  }
  content.needed = {Rung::memory, "because"};
  content.recommended = {Rung::evolution, true, "by far"};
  content.rehearsals = {PathKind::turning, 7,     true,
                        {"nu up to 0.8"},  0.875, {{Rung::evolution, {{0.1, 7, 0.2, 0.3}, 0.4}, {}, {}}}};
  content.warnings = {"outside rehearsals"};
  content.failures = {{Rung::memory, predict::Initial::law, 4, "too hard"}};
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
  EXPECT_EQ(read.recommended.rung, Rung::evolution);
  EXPECT_TRUE(read.recommended.rehearsed);
  EXPECT_EQ(read.recommended.why, "by far");
  ASSERT_TRUE(read.rehearsals);
  EXPECT_EQ(read.rehearsals->kind, PathKind::turning);
  EXPECT_EQ(read.rehearsals->outside, std::vector<std::string>{"nu up to 0.8"});
  EXPECT_EQ(read.rehearsals->models.at(0).P_star.error.largest, 0.3);
  EXPECT_EQ(read.rehearsals->models.at(0).P_star.whole_curve, 0.4);
  EXPECT_EQ(read.warnings, std::vector<std::string>{"outside rehearsals"});
  ASSERT_EQ(read.failures.size(), 1u);
  EXPECT_EQ(read.failures[0].seed, 4u);
  EXPECT_EQ(read.failures[0].error, "too hard");
  ASSERT_EQ(read.changes.size(), 1u);
  EXPECT_EQ(read.changes[0].richer, Rung::evolution);
  EXPECT_EQ(read.changes[0].difference.F, 0.003);
  EXPECT_EQ(read.bands, "of the mean curve");
  ASSERT_TRUE(read.dem);
  EXPECT_EQ(read.dem->digest, written.dem->digest);
  // a curve that is cut, or of another prediction
  auto rows = written.curves[0].prediction.rows;
  rows.pop_back();
  predict::write_prediction_series(folder_ / written.curves[0].file, rows);
  EXPECT_NE(refusal([&] { predict::read_prediction(folder_); }).find(written.curves[0].file + ": has "),
            std::string::npos);
  predict::write_prediction_series(folder_ / written.curves[0].file, written.curves[0].prediction.rows);
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
