// Hard case F12: calibrate -> JSON -> predict keeps every double, also where numbers are written 1.234,5.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "fit/calibrate.hpp"
#include "model/files/column.hpp"
#include "model/files/dataset.hpp"
#include "model/files/series_csv.hpp"
#include "model/parameters_file.hpp"
#include "predict/prediction_files.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/german_locale.hpp"
#include "tests/support/synthetic_dataset.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

using testing::GermanLocale;

bool differ(double a, double b) { return std::memcmp(&a, &b, sizeof a) != 0 && !(std::isnan(a) && std::isnan(b)); }

/// Doubles of two series that differ in any bit.
template <class Row>
int differing(const std::vector<Row>& a, const std::vector<Row>& b, const std::vector<Column<Row>>& columns) {
  if (a.size() != b.size()) return static_cast<int>(std::max(a.size(), b.size()));
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (const auto& column : columns) count += differ(column.get(a[i]), column.get(b[i])) ? 1 : 0;
  }
  return count;
}

std::vector<TestRecord> records() {
  testing::SyntheticOptions options;
  options.rows = 60;
  auto all = testing::SyntheticDataset(testing::synthetic_truth(), options).records();
  for (TestRecord& record : all) {
    for (std::size_t i = 0; i < record.rows.size(); ++i) record.rows[i].time = 1e-3 * static_cast<double>(i) / 7;
  }
  return all;
}

predict::Prediction predicted(const CalibratedLaw& law) {
  const Path path{0.7, Branch::unloading, {{Mode::UNI, direction_of(Mode::UNI), ExtentKind::target_nu, 0.8}}};
  const auto segments = resolve(path);
  return predict::predict(Rung::evolution, law.parameters, law.coupling, segments,
                          predict::state_from_law(law.parameters, path.nu), predict::uniform_points(segments, 50), {},
                          {}, {});
}

class Locale : public testing::TemporaryFolder {};

TEST_F(Locale, F12KeepsEveryDouble) {
  const std::vector<TestRecord> tests = records();
  const CalibratedLaw fitted = fit::calibrate(tests, {}, {}).law;
  const predict::Prediction before = predicted(fitted);
  write_parameters(folder_ / "plain.json", {fitted, {}});
  int count = 0;
  {
    const GermanLocale german(folder_);
    if (!german.in_c()) GTEST_LOG_(INFO) << "no German locale could be made; only the C++ locale was changed";
    ASSERT_EQ(fmt::format("{}", 1.5), "1.5");

    // data set: disk and back, then the fit again
    Dataset dataset;
    for (const TestRecord& record : tests) {
      write_series(folder_ / (record.name + ".csv"), record.rows);
      dataset.tests.push_back({record, "", "", {}, {}});
    }
    write_dataset_index(folder_, dataset);
    std::vector<TestRecord> read;
    for (const DatasetTest& test : read_dataset(folder_).tests) read.push_back(test.record);
    for (std::size_t i = 0; i < tests.size(); ++i)
      count += differing(read[i].rows, tests[i].rows, columns_of<Observation>());
    const CalibratedLaw again = fit::calibrate(read, {}, {}).law;

    // parameters: disk and back, then the prediction
    write_parameters(folder_ / "parameters.json", {again, {}});
    EXPECT_EQ(content(folder_ / "parameters.json"), content(folder_ / "plain.json"));
    const CalibratedLaw loaded = read_parameters(folder_ / "parameters.json").law;
    const auto a = fields(fitted.parameters), b = fields(loaded.parameters);
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      if (fitted.estimates[i].status == Status::not_identified) continue;
      count += differ(*a[i], *b[i]) ? 1 : 0;
    }
    const predict::Prediction after = predicted(loaded);
    count += differing(after.rows, before.rows, columns_of<predict::PredictedRow>());
    predict::write_prediction_series(folder_ / "p.csv", after.rows);
    for (const char* name : {"P_star", "s_par", "F_par"}) {
      const auto from_disk = predict::read_prediction_series(folder_ / "p.csv");
      for (const auto& column : columns_of<predict::PredictedRow>()) {
        if (column.name != name) continue;
        for (std::size_t i = 0; i < before.rows.size(); ++i) {
          count += differ(column.get(from_disk.at(i)), column.get(before.rows[i])) ? 1 : 0;
        }
      }
    }
  }
  testing::expect_figure("F12.differing_doubles_along_the_chain", count, 0);
}

}  // namespace
}  // namespace grainlaw::app
