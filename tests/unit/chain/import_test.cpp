// Our own series as others would write them, and back: names, units, signs, axes and measures must not matter.
#include "chain/import/import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "chain/import/quantity.hpp"
#include "dem/files/state_file.hpp"
#include "model/files/column.hpp"
#include "model/files/series_csv.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::chain {
namespace {

const std::filesystem::path kStarter = std::filesystem::path(GRAINLAW_SOURCE_DIR) / "examples" / "starters" / "dataset";

/// A column of a foreign table: its title and what a row of ours has there.
struct Written {
  std::string title;
  std::function<double(const Observation&)> value;
};

std::string table_text(const std::vector<Observation>& rows, const std::vector<Written>& columns, int digits = 17) {
  std::string text;
  for (const Written& column : columns) text += (text.empty() ? "" : ";") + column.title;
  for (const Observation& row : rows) {
    text += '\n';
    for (std::size_t i = 0; i < columns.size(); ++i)
      text += fmt::format("{}{:.{}g}", i == 0 ? "" : ";", columns[i].value(row), digits);
  }
  return text + '\n';
}

/// Components of ours under other axes: theirs x, y, z are our `axes`.
void add_tensor(const std::string& prefix, const std::string& unit, double factor, const std::array<int, 3>& axes,
                std::function<const Eigen::Matrix3d&(const Observation&)> tensor, std::vector<Written>& columns) {
  for (std::size_t c = 0; c < 6; ++c) {
    const auto [i, j] = kComponentIndex[c];
    const int a = axes[static_cast<std::size_t>(i)], b = axes[static_cast<std::size_t>(j)];
    columns.push_back(
        {prefix + kComponentName[c] + unit, [=](const Observation& o) { return factor * tensor(o)(a, b); }});
  }
}

class Import : public testing::TemporaryFolder {
 protected:
  static const Dataset& ours() {
    static const Dataset dataset = read_dataset(kStarter);
    return dataset;
  }
  static const TestRecord& ours(const std::string& name) {
    return std::ranges::find(ours().tests, name, [](const DatasetTest& t) { return t.record.name; })->record;
  }

  /// The data set of one table with the packing of `record`.
  TestRecord imported_from(const std::string& table, const TestRecord& record, const std::string& series,
                           const std::string& of_test = "") const {
    put("t.csv", table);
    const std::string packing =
        fmt::format(R"("particles": 1000, "seed": 7, "mean_radius": {:.17g}, "stiffness": {:.17g})",
                    record.packing.mean_radius, record.packing.stiffness);
    return imported_by(fmt::format(R"({{"source": "us", "packings": {{"A": {{{}}}}},
      "tests": [{{"name": "t", "role": "calibration", {} "series": {{"file": "t.csv" {}}}}}]}})",
                                   packing, of_test, series));
  }
  TestRecord imported_by(const std::string& mapping) const {
    const Mapping read = read_mapping(put("mapping.json", mapping));
    const std::vector<ForeignTest> foreign = read_foreign(read, {});
    notes_ = foreign.front().foreign.notes;
    const std::vector<ImportedTest> tests{chain::imported(read, foreign.front())};
    return write_imported(read, foreign, tests, folder_ / "out", {}).tests.front().record;
  }

  mutable std::vector<std::string> notes_;
};

TEST_F(Import, NamesUnitsSignsAndAxesDoNotMatter) {
  const std::array<int, 3> axes{2, 0, 1};  // their x is our z
  for (const char* name : {"D2-0.71-s1", "ISO-unloading-s2"}) {
    const TestRecord& record = ours(name);
    std::vector<Written> columns{{"junk, of theirs", [](const Observation& o) { return 3 * o.nu; }},
                                 {"e", [](const Observation& o) { return 1 / o.nu - 1; }},
                                 {"phi_r (%)", [](const Observation& o) { return 100 * o.rattler_fraction; }},
                                 {"C*", [](const Observation& o) { return o.C_star; }},
                                 {"time [ms]", [](const Observation& o) { return 1e3 * o.time; }},
                                 {"mean overlap", [](const Observation& o) { return o.mean_overlap; }}};
    add_tensor(
        "eps_", "[%]", -100, axes, [](const Observation& o) -> const Eigen::Matrix3d& { return o.strain.tensor; },
        columns);
    add_tensor(
        "sigma_", "(kPa)", -1e-3, axes, [](const Observation& o) -> const Eigen::Matrix3d& { return o.stress.tensor; },
        columns);
    add_tensor(
        "F", "", 1, axes, [](const Observation& o) -> const Eigen::Matrix3d& { return o.fabric.tensor; }, columns);
    const TestRecord back =
        imported_from(table_text(record.rows, columns), record, R"(, "sign": {"strain": "compression"})");
    ASSERT_EQ(back.rows.size(), record.rows.size());
    ASSERT_EQ(back.path.segments.size(), 1u);
    EXPECT_EQ(back.path.segments[0].mode, record.path.segments[0].mode);
    EXPECT_NEAR(back.path.segments[0].extent,
                std::abs(record.rows.back().eps_dev > 0.01 ? record.rows.back().eps_dev : record.rows.back().eps_vol),
                1e-5);
    for (std::size_t i = 0; i < record.rows.size(); ++i) {
      const Observation &is = record.rows[i], &got = back.rows[i];
      EXPECT_NEAR(got.P_star, is.P_star, 1e-14) << i;
      EXPECT_EQ(std::isnan(got.C_star), std::isnan(is.C_star));
      if (!std::isnan(is.C_star)) {
        EXPECT_NEAR(got.C_star, is.C_star, 1e-13);
      }
      EXPECT_NEAR(got.rattler_fraction, is.rattler_fraction, 1e-15);
      EXPECT_NEAR(got.mean_overlap, is.mean_overlap, 1e-15);
      EXPECT_NEAR(got.time, is.time, 1e-15);
      EXPECT_NEAR(got.eps_dev, is.eps_dev, 1e-5);  // the starter's own strains have six digits
      EXPECT_NEAR(got.nu, is.nu, 1e-5);
      EXPECT_NEAR(got.F_v, is.F_v, 1e-14);
      if (is.eps_dev < 0.01) continue;
      EXPECT_NEAR(got.s_par, is.s_par, 1e-13);
      EXPECT_NEAR(got.F_par, is.F_par, 1e-13);
    }
    EXPECT_EQ(content(folder_ / "out" / "t.extra.csv").substr(0, 21), "row,junk_ of theirs\n1");
  }
}

TEST_F(Import, TakesWhatIsEvident) {
  const TestRecord& record = ours("ISO-unloading-s1");
  const TestRecord back = imported_from(
      table_text(record.rows, {{"p[MPa]", [](const Observation& o) { return -1e-6 * o.stress.tensor.trace() / 3; }},
                               {"nu", [](const Observation& o) { return o.nu; }}}),
      record, R"(, "isotropic": true)");
  EXPECT_EQ(notes_, (std::vector<std::string>{"stress: tension is positive, since grains only push"}));
  for (std::size_t i = 0; i < record.rows.size(); ++i) {
    EXPECT_NEAR(back.rows[i].P_star, record.rows[i].P_star, 1e-14);
    EXPECT_NEAR(back.rows[i].nu, record.rows[i].nu, 1e-14);
    EXPECT_TRUE(back.rows[i].fabric.tensor.array().isNaN().all() && std::isnan(back.rows[i].C_star));
  }
  EXPECT_EQ(back.path.segments[0].mode, Mode::ISO);
}

// A triaxial test in a laboratory's terms: eps_a and eps_v nominal in per cent, compression positive, axis y.
TEST_F(Import, ReadsALaboratory) {
  std::string table = "eps_a[%],eps_v[%],p'[kPa],q[kPa],e\n";
  std::vector<Eigen::Vector3d> strain, stress;
  const double nu_0 = 0.64;
  for (int i = 0; i <= 20; ++i) {
    const double a = -0.004 * i, r = 0.0015 * i, q = 40 * (1 - std::exp(-0.3 * i)),
                 p = 100 + q / 3;  // logarithmic, tension positive
    strain.emplace_back(r, a, r);
    stress.emplace_back(p - q / 3, p + 2 * q / 3, p - q / 3);
    const double volume = a + 2 * r;
    table += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", -100 * std::expm1(a), -100 * std::expm1(volume),
                         p, q, std::exp(volume) / nu_0 - 1);
  }
  TestRecord record;
  record.packing = {1, 1000, 3, 0.5, 1e6};  // P* of 100 kPa: 0.1
  const TestRecord back = imported_from(
      table, record,
      R"(, "measure": "nominal", "axis": "y", "sign": {"stress": "compression", "strain": "compression"})");
  ASSERT_EQ(back.rows.size(), strain.size());
  for (std::size_t i = 0; i < strain.size(); ++i) {
    EXPECT_LT((back.rows[i].strain.tensor.diagonal() - strain[i]).norm(), 1e-13) << i;
    EXPECT_LT((back.rows[i].stress.tensor.diagonal() - 1e3 * stress[i]).norm(), 1e-9) << i;
    EXPECT_NEAR(back.rows[i].P_star, 1e3 * stress[i].sum() / 3 / 1e6, 1e-15);
  }
}

TEST_F(Import, ReadsEdgesAndEngineeringShear) {
  const TestRecord& record = ours("ISO-unloading-s1");
  const auto edge = [](int i, double first) {
    return [=](const Observation& o) { return first * std::exp(o.strain.tensor(i, i)); };
  };
  const Written nu{"phi", [](const Observation& o) { return o.nu; }};
  std::vector<Written> columns{{"Lx[mm]", edge(0, 3)}, {"Ly[mm]", edge(1, 4)}, {"Lz[mm]", edge(2, 5)}, nu};
  add_tensor(
      "s", "[Pa]", 1, {0, 1, 2}, [](const Observation& o) -> const Eigen::Matrix3d& { return o.stress.tensor; },
      columns);
  const TestRecord back = imported_from(table_text(record.rows, columns), record, "");
  for (std::size_t i = 0; i < record.rows.size(); ++i) EXPECT_NEAR(back.rows[i].eps_vol, record.rows[i].eps_vol, 2e-5);

  std::string table = "exx,eyy,ezz,exy,sxx,syy,szz,sxy\n";
  for (int i = 0; i <= 10; ++i) table += fmt::format("0,0,0,{:.17g},100,100,100,{:.17g}\n", 0.02 * i, -0.5 * i);
  TestRecord other;
  other.packing = {1, 1000, 3, 0.5, 1e4};
  const TestRecord sheared = imported_from(table, other,
                                           R"(, "shear": "engineering", "nu_start": 0.7, "units": {"stress": "Pa"},
                                              "sign": {"strain": "tension"})");
  EXPECT_NEAR(sheared.rows.back().strain.tensor(0, 1), 0.1, 1e-15);
  EXPECT_NEAR(sheared.rows.back().nu, 0.7, 1e-15);
}

TEST_F(Import, RefusesWithFileLineColumnAndRemedy) {
  const TestRecord& record = ours("D2-0.71-s1");
  std::vector<Written> columns{{"t", [](const Observation& o) { return o.time; }},
                               {"nu", [](const Observation& o) { return o.nu; }}};
  add_tensor(
      "e", "", 1, {0, 1, 2}, [](const Observation& o) -> const Eigen::Matrix3d& { return o.strain.tensor; }, columns);
  add_tensor(
      "s", "[kPa]", 1e-3, {0, 1, 2}, [](const Observation& o) -> const Eigen::Matrix3d& { return o.stress.tensor; },
      columns);
  const std::string declared = R"(, "sign": {"strain": "tension", "stress": "compression"})";
  const auto why = [&](const std::function<void(std::vector<Observation>&)>& change, const std::string& series,
                       const std::string& of_test = "") {
    std::vector<Observation> rows = record.rows;
    change(rows);
    std::filesystem::remove_all(folder_ / "out");
    const std::string message =
        testing::refusal([&] { imported_from(table_text(rows, columns), record, series, of_test); });
    EXPECT_EQ(std::filesystem::exists(folder_ / "out"), message == "accepted") << message;
    return message;
  };
  const auto nothing = [](std::vector<Observation>&) {};
  const auto expect_parts = [](const std::string& message, std::initializer_list<const char*> parts) {
    for (const char* part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << part << " is not in: " << message;
  };
  EXPECT_EQ(why(nothing, declared), "accepted");
  expect_parts(why(nothing, ""), {"t.csv: the sign of the strain is neither declared nor evident", "mapping.json"});
  expect_parts(why(nothing, R"(, "sign": {"strain": "tension", "stress": "tension"})"),
               {"t.csv: line ", "column 'sxx[kPa]'", "stress sign?", R"({"stress": "compression"})"});
  expect_parts(why(nothing, R"(, "sign": {"strain": "compression", "stress": "compression"})"),
               {"t.csv: line ", "column 'sxx[kPa]'", "the sign of the strain"});
  expect_parts(why([](auto& rows) { rows[4].stress.tensor(0, 0) = NAN; }, declared),
               {"t.csv: line 6, column 'sxx[kPa]': is undefined", "remove"});
  expect_parts(why([](auto& rows) { std::swap(rows[4].time, rows[5].time); }, declared),
               {"t.csv: line 7, column 't': the time", "sort"});
  expect_parts(why([](auto& rows) { rows[7].nu *= 1.01; }, declared), {"t.csv: line 9, column 'nu': is 0.717"});
  expect_parts(why(
                   [](auto& rows) {
                     for (auto& row : rows) row.stress.tensor *= 1000;
                   },
                   declared),
               {"t.csv: line 2, column 'sxx[kPa]'", "units"});
  expect_parts(why(
                   [](auto& rows) {
                     rows[9].strain.tensor(0, 0) += 1e-3;
                     rows[9].strain.tensor(2, 2) -= 1e-3;
                   },
                   declared, R"("path": {"segments": [{"mode": "UNI", "extent": {"eps_dev": 0.2}}]},)"),
               {"t.csv: line ", "path_tolerance", "path"});
  expect_parts(why(nothing, declared, R"("path": {"segments": [{"mode": "D2", "extent": {"eps_dev": 0.1003}},
                                                              {"mode": "D2", "extent": {"eps_dev": 0.16}}]},)"),
               {"t.csv: line ", "is the last row of segment 0", "before its end; keep the row at each corner"});
  expect_parts(why(nothing, declared + R"(, "columns": {"nu": "phi"})"),
               {"t.csv: has no column 'phi', but t, nu, exx"});
  expect_parts(why(nothing, declared + R"(, "columns": {"density": "nu"})"),
               {"mapping.json: test t: series.columns.density: is no quantity"});
  expect_parts(why(nothing, declared + R"(, "columns": {"nu": "nu"})"), {"t.csv: misses the strain"});
  expect_parts(why(nothing, declared + R"(, "names": ["a"])"), {"t.csv: has 14 columns where names has 1"});
}

TEST_F(Import, NamesTheFirstOfManyTextsThatAreNoNumbers) {
  const TestRecord& record = ours("ISO-unloading-s1");  // whose sign of strain is read from its last row
  std::string table = "exx;eyy;ezz;nu;sxx[Pa];syy[Pa];szz[Pa]";
  for (const Observation& row : record.rows) {
    const Eigen::Vector3d e = row.strain.tensor.diagonal(), s = row.stress.tensor.diagonal();
    table += fmt::format("\n{}%;{};{};{};{};{};{}", e(0), e(1), e(2), row.nu, s(0), s(1), s(2));
  }
  const std::string message = testing::refusal([&] { imported_from(table, record, ""); });
  EXPECT_NE(message.find("t.csv: line 2, column 'exx': '0%' is no number"), std::string::npos) << message;
}

TEST_F(Import, RefusesWhatBecomesInfinite) {
  const auto mapping =
      read_mapping(put("mapping.json", R"({"source": "us", "packings": {"A": {"particles": 1000, "mean_radius": 1e-3,
      "stiffness": 1e8}}, "tests": [{"name": "t", "role": "calibration", "series": {"file": "t.csv", "sign": {"strain": "tension"}}}]})"));
  put("t.csv", series_text(ours("D2-0.71-s1").rows));
  std::vector<ForeignTest> foreign = read_foreign(mapping, {});
  EXPECT_EQ(testing::refusal([&] { imported(mapping, foreign[0]); }), "accepted");
  foreign[0].foreign.rows[3].E_kin = std::numeric_limits<double>::infinity();
  const std::string message = testing::refusal([&] { imported(mapping, foreign[0]); });
  EXPECT_NE(message.find("line 5"), std::string::npos) << message;
  EXPECT_NE(message.find("E_kin becomes infinite"), std::string::npos) << message;
}

// Forces of other contacts than k delta stand in no state, and a stand-in for the stiffness is none.
TEST_F(Import, ParticlesWithoutForcesAreThoseOfPlainContacts) {
  dem::scene::Draw draw(5);
  dem::State state = dem::scene::random_state(100, 3, 0.7, Eigen::Matrix3d::Identity(), draw);
  const auto why = [&](const std::string& packing) {
    dem::write_state(folder_ / "a.state", state);
    return testing::refusal([&] {
      imported_by(
          fmt::format(R"({{"source": "us", "packings": {{"A": {{"particles": 100 {}}}}}, "tests": [{{"name": "t",
          "role": "calibration", "particles": {{"format": "state", "files": ["a.state"]}}}}]}})",
                      packing));
    });
  };
  EXPECT_NE(why(R"(, "stress_unit": 1e9)").find("give 'stiffness' in packings.A"), std::string::npos);
  EXPECT_NE(why(R"(, "stiffness": 1e7)").find("stiffness: is 10000000 but"), std::string::npos);
  EXPECT_NE(why(R"(, "normal_force": "hertz")").find("give 'contacts' with the forces"), std::string::npos);
  state.contacts.friction = 0.1;
  EXPECT_NE(why("").find("was made with other contacts than k delta"), std::string::npos);
}

TEST_F(Import, NeedsUnitsOfStressUnlessItHasNone) {
  std::string table = "p nu\n";
  for (int i = 0; i <= 10; ++i) table += fmt::format("{:.17g} {:.17g}\n", 0.002 + 0.005 * i, 0.67 + 0.008 * i);
  put("t.csv", table);
  const auto by = [&](const std::string& packing, const std::string& series) {
    return fmt::format(R"({{"source": "us", "packings": {{"A": {{"particles": 1000 {}}}}},
      "tests": [{{"name": "t", "role": "calibration", "series": {{"file": "t.csv", "isotropic": true {}}}}}]}})",
                       packing, series);
  };
  EXPECT_NEAR(imported_by(by(R"(, "dimensionless": true)", "")).rows[2].P_star, 0.012, 1e-16);
  EXPECT_NEAR(imported_by(by(R"(, "stress_unit": 1e9)", R"(, "units": {"stress": "GPa"})")).rows[2].P_star, 0.012,
              1e-16);
  EXPECT_NEAR(imported_by(by(R"(, "stress_unit": 1e9)", R"(, "columns": {"P_star": "p", "nu": "nu"})")).rows[2].P_star,
              0.012, 1e-16);
  const auto why = [&](const std::string& packing, const std::string& series) {
    return testing::refusal([&] { imported_by(by(packing, series)); });
  };
  EXPECT_NE(why(R"(, "stress_unit": 1e9)", "").find("t.csv: column 'p' (p) has no unit; give \"units\""),
            std::string::npos);
  EXPECT_NE(
      why(R"(, "stress_unit": 1e9)", R"(, "units": {"stress": "psi"})").find("'psi' is no unit of it that is known"),
      std::string::npos);
  EXPECT_NE(why(R"(, "stress_unit": 1e9)", R"(, "units": {"stress": "kPa"})").find("units of the stress right?"),
            std::string::npos);
  EXPECT_NE(why(R"(, "dimensionless": true)", R"(, "units": {"stress": "kPa"})").find("the packing is dimensionless"),
            std::string::npos);
  EXPECT_NE(why(R"(, "dimensionless": true)", R"(, "nu_start": 0.7)").find("leave nu_start out"), std::string::npos);
  EXPECT_NE(why("", "").find("misses the key 'mean_radius'"), std::string::npos);
  EXPECT_NE(why(R"(, "stress_unit": 1, "dimensionless": true)", "").find("says twice"), std::string::npos);
}

// A file in another unit than the others is no contradiction in itself.
TEST_F(Import, SuspectsUnitsThatDifferBetweenTests) {
  std::vector<ImportedTest> tests;
  for (const char* name : {"ISO-unloading-s1", "D2-0.71-s1", "D2-0.75-s1"}) tests.push_back({ours(name), {}, {}});
  EXPECT_TRUE(suspicions(tests).empty());
  for (Observation& row : tests[2].record.rows) row.P_star /= 1000;
  ASSERT_EQ(suspicions(tests).size(), 1u);
  EXPECT_NE(suspicions(tests)[0].find("test D2-0.75-s1 starts at P* = "), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::chain
