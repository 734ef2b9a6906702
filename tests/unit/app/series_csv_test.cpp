#include "model/files/series_csv.hpp"
#include "model/files/column.hpp"
#include "model/vocabulary/series_check.hpp"
#include "predict/prediction_files.hpp"

#include <cmath>
#include <cstring>
#include <set>

#include "tests/support/synthetic_dataset.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

using testing::refusal;

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b)); }

/// A D2 test with a value in every column.
TestRecord full_record() {
  testing::SyntheticOptions options;
  options.seeds = {1};
  options.densities = {0.7};
  options.rows = 20;
  TestRecord record = testing::SyntheticDataset(testing::synthetic_truth(), options).records().at(1);
  const std::set<std::string> consistent{"segment", "eps_vol", "eps_dev", "shear_path", "nu",    "P_star",
                                         "s_dev",   "s_par",   "F_v",     "F_dev",      "F_par", "time"};
  double value = 0.1;
  for (std::size_t i = 0; i < record.rows.size(); ++i) {
    Observation& row = record.rows[i];
    row.time = 1e-3 * static_cast<double>(i);
    for (const auto& column : columns_of<Observation>()) {
      if (!consistent.contains(column.name) && std::isnan(column.get(row))) column.set(row, value *= -1.37);
    }
  }
  return record;
}

class SeriesCsv : public testing::TemporaryFolder {
 protected:
  SeriesCsv() : record_(full_record()) {}

  std::vector<Observation> read(const std::string& text) const {
    return read_series(put("s.csv", text), record_.path, record_.packing);
  }
  std::string refusal_of(const std::string& text) const {
    const std::string message = refusal([&] { read(text); });
    const auto name = message.find("s.csv: ");
    return name == std::string::npos ? message : message.substr(name + 7);
  }
  /// The series without some columns, with rows `edit`ed.
  std::string text_without(const std::set<std::string>& names,
                           const std::function<void(Observation&)>& edit = {}) const {
    std::string text;
    std::vector<Observation> rows = record_.rows;
    for (int line = -1; line < static_cast<int>(rows.size()); ++line) {
      std::string separator;
      if (line >= 0 && edit) edit(rows[static_cast<std::size_t>(line)]);
      for (const auto& column : columns_of<Observation>()) {
        if (names.contains(column.name)) continue;
        text += separator +
                (line < 0 ? column.title() : fmt::format("{}", column.get(rows[static_cast<std::size_t>(line)])));
        separator = ",";
      }
      text += "\n";
    }
    return text;
  }

  TestRecord record_;
};

TEST_F(SeriesCsv, IsReadBackBitForBit) {
  write_series(folder_ / "s.csv", record_.rows);
  const auto rows = read_series(folder_ / "s.csv", record_.path, record_.packing);
  ASSERT_EQ(rows.size(), record_.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& column : columns_of<Observation>()) {
      EXPECT_TRUE(same_bits(column.get(rows[i]), column.get(record_.rows[i]))) << column.name << " in row " << i;
    }
  }
}

TEST_F(SeriesCsv, HeaderNamesUnits) {
  const std::string text = series_text({});
  EXPECT_TRUE(
      text.starts_with("time[s],segment,strain_xx,strain_yy,strain_zz,strain_yz,strain_xz,strain_xy,eps_vol,eps_dev,"));
  EXPECT_NE(text.find(",stress_xx[Pa],"), std::string::npos);
}

TEST_F(SeriesCsv, ComputesWhatFollowsFromRequiredColumns) {
  std::set<std::string> optional;
  for (const auto& column : columns_of<Observation>()) {
    if (!column.required() && !column.name.starts_with("fabric_")) optional.insert(column.name);
  }
  const auto rows = read(text_without(optional));
  ASSERT_EQ(rows.size(), record_.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Observation &a = rows[i], &b = record_.rows[i];
    EXPECT_NEAR(a.P_star, b.P_star, 1e-14);
    EXPECT_NEAR(a.s_par, b.s_par, 1e-12);
    EXPECT_NEAR(a.F_par, b.F_par, 1e-14);
    EXPECT_NEAR(a.F_v, b.F_v, 1e-12);
    EXPECT_NEAR(a.eps_dev, b.eps_dev, 1e-14);
    EXPECT_NEAR(a.shear_path, b.shear_path, 1e-12);
    EXPECT_TRUE(std::isnan(a.mean_overlap));
    EXPECT_TRUE(std::isnan(a.time));
  }
}

// Hard cases S3 and F7: wrong units and swapped columns do not pass.
TEST_F(SeriesCsv, RefusesContradictions) {
  EXPECT_NE(refusal_of(text_without({"E_kin"}, [](Observation& r) { r.stress.tensor *= 1000; }))
                .find("row 1, column 'P_star': "),
            std::string::npos);
  EXPECT_NE(refusal_of(text_without({"E_kin"}, [](Observation& r) { std::swap(r.s_par, r.F_par); }))
                .find("row 2, column 's_par'"),
            std::string::npos);
  EXPECT_NE(refusal_of(text_without({"E_kin"}, [](Observation& r) { r.nu += r.eps_dev > 0.1 ? 0.01 : 0; }))
                .find("column 'nu'"),
            std::string::npos);
  EXPECT_NE(refusal_of(text_without({"E_kin"}, [](Observation& r) { r.time = 0; }))
                .find("row 2, column 'time[s]': does not grow"),
            std::string::npos);
  EXPECT_NE(refusal_of(text_without({"E_kin"}, [](Observation& r) { r.segment = 1; }))
                .find("row 1, column 'segment': 1 is no segment"),
            std::string::npos);
}

TEST_F(SeriesCsv, GoesWithoutFabricAndContacts) {
  std::set<std::string> optional;
  for (const auto& column : columns_of<Observation>()) {
    if (!column.required()) optional.insert(column.name);
  }
  const auto rows = read(text_without(optional));
  ASSERT_EQ(rows.size(), record_.rows.size());
  for (const Observation& row : rows) {
    EXPECT_TRUE(row.fabric.tensor.array().isNaN().all() && std::isnan(row.F_v) && std::isnan(row.F_par) &&
                std::isnan(row.C_star));
    EXPECT_TRUE(std::isfinite(row.P_star));
  }
  EXPECT_EQ(refusal([&] { check_series(rows, record_.path, record_.packing, "t"); }), "accepted");
}

TEST_F(SeriesCsv, RefusesUnknownAndMissingColumns) {
  std::string text = text_without({});
  EXPECT_EQ(refusal_of(text), "accepted");
  EXPECT_NE(refusal_of("extra," + text).find("unknown column 'extra'"), std::string::npos);
  const std::string pascal = "stress_xx[Pa]";
  std::string kilo = text;
  kilo.replace(kilo.find(pascal), pascal.size(), "stress_xx[kPa]");
  EXPECT_NE(refusal_of(kilo).find("column 'stress_xx[kPa]' must be in its unit: 'stress_xx[Pa]'"), std::string::npos);
  EXPECT_NE(refusal_of(text_without({"nu"})).find("misses the column 'nu'"), std::string::npos);
  EXPECT_NE(refusal_of(text_without({"fabric_xy"})).find("has 5 of the six columns of fabric; give all or none"),
            std::string::npos);
  EXPECT_NE(refusal_of(text.substr(0, text.find('\n') + 1)).find("the series has no rows"), std::string::npos);
}

TEST_F(SeriesCsv, RefusesEmptyFieldsWhereANumberIsNeeded) {
  EXPECT_NE(
      refusal_of(text_without({}, [](Observation& r) { r.strain.tensor(0, 0) = NAN; })).find("column 'strain_xx'"),
      std::string::npos);
  EXPECT_NE(refusal_of(text_without({}, [](Observation& r) { r.E_kin = INFINITY; }))
                .find("row 1, column 'E_kin[J]': 'inf' is not a finite number"),
            std::string::npos);
}

// Found by the fuzzer: such a row was taken, and could not be written again.
TEST_F(SeriesCsv, RefusesNumbersWhoseNormIsInfinite) {
  const std::string text = text_without({"s_dev", "s_par"}, [](Observation& r) {
    if (r.eps_dev > 0.1) r.stress.tensor(0, 1) = r.stress.tensor(1, 0) = 1e308;
  });
  EXPECT_NE(refusal_of(text).find("s_dev becomes infinite"), std::string::npos) << refusal_of(text);
}

TEST_F(SeriesCsv, OfAPredictionIsReadBack) {
  const auto segments = resolve(record_.path);
  const auto start = predict::state_from_law(testing::synthetic_truth(), record_.path.nu);
  const auto prediction = predict::predict(Rung::evolution, testing::synthetic_truth(), Coupling::energy, segments,
                                           start, predict::uniform_points(segments, 10), {}, {}, {});
  predict::write_prediction_series(folder_ / "p.csv", prediction.rows);
  const auto rows = predict::read_prediction_series(folder_ / "p.csv");
  ASSERT_EQ(rows.size(), prediction.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_TRUE(same_bits(rows[i].state.P, prediction.rows[i].state.P));
    EXPECT_TRUE(same_bits(rows[i].s_par, prediction.rows[i].s_par));
    EXPECT_TRUE(same_bits(rows[i].F_par, prediction.rows[i].F_par));
    EXPECT_LT((rows[i].state.sigma - prediction.rows[i].state.sigma).norm(), 1e-15);
    EXPECT_LT((rows[i].state.F - prediction.rows[i].state.F).norm(), 1e-15);
  }
  EXPECT_NE(refusal([&] {
              predict::read_prediction_series(put("q.csv", "segment\n0\n"));
            }).find("misses the column 'strain_xx'"),
            std::string::npos);
  for (const char* segment : {"2147483648", "1e300", "0.5"}) {
    std::string text = content(folder_ / "p.csv");
    ASSERT_TRUE(text.starts_with("segment,"));
    const std::size_t at = text.find('\n') + 1;
    text.replace(at, text.find(',', at) - at, segment);
    EXPECT_NE(refusal([&] { predict::read_prediction_series(put("q.csv", text)); }).find("row 1, column 'segment'"),
              std::string::npos)
        << segment;
  }
}

}  // namespace
}  // namespace grainlaw::app
