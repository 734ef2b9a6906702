// Data that lie: each lie is sown into a good file of the paper-size calibration that is shipped.

#include "model/vocabulary/series_check.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "model/files/dataset.hpp"
#include "model/files/path_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw {
namespace {

using Rows = std::vector<Observation>;
using testing::refusal;

const std::filesystem::path kShipped = std::filesystem::path(GRAINLAW_SOURCE_DIR) / "examples/paper/data";

const Dataset& shipped() {
  static const Dataset dataset = read_dataset(kShipped / "dataset");
  return dataset;
}

TestRecord good(const std::string& name) {
  const auto& tests = shipped().tests;
  const auto test = std::find_if(tests.begin(), tests.end(), [&](const auto& t) { return t.record.name == name; });
  if (test == tests.end()) throw std::invalid_argument(name);
  return test->record;
}

/// Columns that nobody must give become those that follow from the needed ones, as read_series() fills them in.
void keep_needed_columns(TestRecord& test) {
  const Deviator<double> N = shear_direction(resolve(test.path));
  for (Observation& o : test.rows) {
    const Observation all = o;
    o = {};
    o.segment = all.segment;
    o.nu = all.nu;
    o.stress = all.stress;
    o.fabric = all.fabric;
    o.C_star = all.C_star;
    o.rattler_fraction = all.rattler_fraction;
    set_strain(o, all.strain);
    const double P = o.stress.tensor.trace() / 3;
    o.P_star = P / test.packing.stress_unit();
    o.F_v = o.fabric.tensor.trace();
    set_ratios(o, P, deviator<double>(o.stress.tensor), deviator<double>(o.fabric.tensor), N);
  }
}

std::string message(const TestRecord& test) {
  return refusal([&] { check_series(test.rows, test.path, test.packing, "s.csv"); });
}

void swap_axes(Eigen::Matrix3d& a, int i, int j) {
  a.row(i).swap(a.row(j));
  a.col(i).swap(a.col(j));
}

/// Sows `lie` into every row of a test that has only the needed columns: nothing else can tell.
void expect_caught(const std::string& name, const std::function<void(Observation&)>& lie,
                   const std::vector<std::string>& words) {
  TestRecord test = good(name);
  for (Observation& row : test.rows) lie(row);
  keep_needed_columns(test);
  const std::string said = message(test);
  EXPECT_TRUE(said.starts_with("s.csv: row ")) << name << ": " << said;
  for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << word << " in: " << said;
  EXPECT_EQ(said.find('\n'), std::string::npos);
}

// As they are, and with only the columns that others must give.
TEST(SeriesCheck, AcceptsAllThatIsShipped) {
  std::vector<Dataset> all{shipped()};
  for (const char* name : {"uniaxial-0.671", "uniaxial-0.695", "uniaxial-0.728"})
    all.push_back(read_dataset(kShipped / name));
  std::size_t tests = 0;
  for (const Dataset& dataset : all) {
    for (const DatasetTest& shipped : dataset.tests) {
      TestRecord test = shipped.record;
      EXPECT_EQ(message(test), "accepted") << test.name;
      keep_needed_columns(test);
      EXPECT_EQ(message(test), "accepted") << test.name;
      ++tests;
    }
  }
  EXPECT_EQ(tests, 160u);
}

// Numbers of five digits say the same.
TEST(SeriesCheck, AcceptsFewDigits) {
  for (const char* name : {"ISO-unloading-s1", "D2-0.68-s1", "D2-ISO-0.74-s2", "UNI-cycle-0.64-s3"}) {
    TestRecord test = good(name);
    keep_needed_columns(test);
    const auto five = [](double x) { return std::stod(fmt::format("{:.5g}", x)); };
    for (Observation& o : test.rows) {
      for (auto* tensor : {&o.strain.tensor, &o.stress.tensor, &o.fabric.tensor}) *tensor = tensor->unaryExpr(five);
      o.nu = five(o.nu);
      o.C_star = five(o.C_star);
    }
    keep_needed_columns(test);
    EXPECT_EQ(message(test), "accepted") << name;
  }
}

TEST(SeriesCheck, NamesTensionPositiveStress) {
  for (const char* name : {"ISO-unloading-s1", "D2-0.68-s2", "D2-0.82-s1", "UNI-cycle-0.64-s1"})
    expect_caught(name, [](Observation& o) { o.stress.tensor *= -1; },
                  {"column 'stress_xx': the mean stress is -", "tension", "change the sign"});
  TestRecord test = good("D2-0.68-s1");  // with a P_star that is right
  for (Observation& o : test.rows) o.stress.tensor *= -1;
  EXPECT_NE(refusal([&] {
              check_contradictions(test.rows, test.path, test.packing, "s.csv");
            }).find("the stress is tension positive, change the sign"),
            std::string::npos);
}

TEST(SeriesCheck, NamesCompressionPositiveStrain) {
  for (const char* name : {"ISO-unloading-s1", "UNI-cycle-0.64-s2"}) {
    expect_caught(name, [](Observation& o) { o.strain.tensor *= -1; },
                  {"column 'nu': is ", "the strain is compression positive, change its sign"});
  }
  expect_caught("D2-0.68-s1", [](Observation& o) { o.strain.tensor *= -1; },
                {"column 'strain': is ", "the strain is compression positive, change its sign"});
  // the path as well: only the work tells
  for (const char* name : {"D2-0.67-s1", "D2-0.74-s3", "D2-0.82-s5", "D3-0.70-s1", "D2-loading-0.79-s2"}) {
    TestRecord test = good(name);
    for (PathSegment& segment : test.path.segments) segment.direction.tensor *= -1;
    for (Observation& o : test.rows) o.strain.tensor *= -1;
    keep_needed_columns(test);
    const std::string said = message(test);
    EXPECT_NE(said.find("column 'stress': its work on the shear"), std::string::npos) << name << ": " << said;
  }
}

TEST(SeriesCheck, NamesOtherMeasuresOfStrain) {
  expect_caught("ISO-unloading-s2", [](Observation& o) { o.strain.tensor *= 100; }, {"column 'nu'", "per cent"});
  expect_caught("D2-0.70-s2", [](Observation& o) { o.strain.tensor *= 100; }, {"column 'strain'", "per cent"});
  expect_caught("ISO-unloading-s2",
                [](Observation& o) { o.strain.tensor.diagonal() = o.strain.tensor.diagonal().array().exp() - 1; },
                {"column 'nu'", "give the logarithmic one"});
}

// D2 extends x and compresses z.
TEST(SeriesCheck, NamesSwappedColumns) {
  for (const char* name : {"D2-0.68-s1", "D2-0.74-s2", "D2-0.79-s3"}) {
    for (const auto& [i, j] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      expect_caught(name, [&, i = i, j = j](Observation& o) { swap_axes(o.stress.tensor, i, j); },
                    {"column 'stress'", "swapped"});
      if (name != std::string("D2-0.79-s3"))  // hardly anisotropic
        expect_caught(name, [&, i = i, j = j](Observation& o) { swap_axes(o.fabric.tensor, i, j); },
                      {"column 'fabric'", "swapped"});
      expect_caught(name, [&, i = i, j = j](Observation& o) { swap_axes(o.strain.tensor, i, j); },
                    {"column 'strain'", "swapped"});
    }
  }
  for (const char* name : {"UNI-cycle-0.64-s1", "D3-0.70-s4"}) {
    expect_caught(name, [](Observation& o) { swap_axes(o.stress.tensor, 0, 2); }, {"column 'stress'", "swapped"});
    expect_caught(name, [](Observation& o) { swap_axes(o.strain.tensor, 1, 2); }, {"column 'strain'", "swapped"});
  }
  expect_caught("D2-0.70-s1", [](Observation& o) { std::swap(o.nu, o.rattler_fraction); }, {"nu"});
  expect_caught("D2-0.70-s1", [](Observation& o) { std::swap(o.C_star, o.rattler_fraction); }, {"rattler_fraction"});
  expect_caught("D2-0.70-s1", [](Observation& o) { std::swap(o.C_star, o.nu); }, {"nu"});
  expect_caught("D2-0.74-s1", [](Observation& o) { std::swap(o.stress.tensor, o.fabric.tensor); }, {"units"});
}

TEST(SeriesCheck, NamesAVolumeFractionOfAnotherVolume) {
  expect_caught("ISO-unloading-s3", [](Observation& o) { o.nu -= 0.01; }, {"column 'nu'", "nu of another volume"});
  expect_caught("D2-0.70-s3", [](Observation& o) { o.nu -= 0.01; },
                {"row 1, column 'nu': is 0.69", "the path starts at initial.nu = 0.7", "another volume"});
  expect_caught("ISO-unloading-s3", [](Observation& o) { o.nu *= 1 - o.rattler_fraction; }, {"column 'nu'"});
}

TEST(SeriesCheck, NamesContactsOfAnotherDefinition) {
  for (const char* name : {"ISO-unloading-s3", "D2-0.70-s1", "D2-0.82-s2"}) {
    expect_caught(name, [](Observation& o) { o.C_star /= 2; }, {"column 'C_star': is ", "once a pair"});
    expect_caught(name, [](Observation& o) { o.fabric.tensor /= 2; }, {"column 'F_v'", "0.6", "once"});
    expect_caught(name, [](Observation& o) { o.fabric.tensor *= 2; },
                  {"column 'F_v'", " times nu (1 - rattler_fraction) C_star", "twice"});
    expect_caught(name, [](Observation& o) { o.fabric.tensor /= o.fabric.tensor.trace(); },
                  {"column 'F_v'", "normalised"});
    expect_caught(name,
                  [](Observation& o) { o.fabric.tensor -= o.fabric.tensor.trace() / 3 * Eigen::Matrix3d::Identity(); },
                  {"fabric", "deviator"});
  }
  expect_caught("ISO-unloading-s3", [](Observation& o) { o.C_star *= 1 - o.rattler_fraction; },
                {"column 'C_star'", "C = M4/N"});
  expect_caught("D2-0.67-s1", [](Observation& o) { o.C_star *= 1 - o.rattler_fraction; },
                {"column 'C_star': is 5.", "C = M4/N with rattlers"});
  expect_caught("D2-0.70-s1", [](Observation& o) { o.rattler_fraction *= 100; },
                {"row 1, column 'rattler_fraction': is 4.7", "in per cent?"});
  expect_caught("D2-0.70-s1", [](Observation& o) { o.rattler_fraction *= -1; },
                {"column 'rattler_fraction': is -0.047"});
}

// No column but the stress itself knows: C* - 6 does.
TEST(SeriesCheck, NamesOtherUnitsOfStress) {
  for (const char* name : {"ISO-unloading-s1", "D2-0.70-s1", "D2-0.82-s2", "UNI-cycle-0.64-s1"}) {
    for (const double unit : {1e-3, 1e-6, 1e-9, 10.0, 0.1, 1e3})
      expect_caught(name, [&](Observation& o) { o.stress.tensor *= unit; }, {"column 'P_star': is ", "units", "Pa"});
    TestRecord test = good(name);
    for (const auto& [radius, stiffness] : {std::pair{1e3, 1.0}, {1.0, 1e-3}}) {
      TestRecord other = test;
      other.packing.mean_radius *= radius;
      other.packing.stiffness *= stiffness;
      keep_needed_columns(other);
      EXPECT_NE(message(other).find("mean_radius in m, stiffness in kg/s^2"), std::string::npos) << message(other);
    }
  }
}

TEST(SeriesCheck, NamesEnergiesOfTheWrongSign) {
  TestRecord test = good("D2-0.70-s1");
  for (Observation& o : test.rows) o.D_contact *= -1;
  EXPECT_NE(message(test).find("column 'D_contact': is -"), std::string::npos) << message(test);
}

TEST(SeriesCheck, SaysWhatContradictsAndWhy) {
  const auto said = [](const std::function<void(Observation&)>& lie) {
    TestRecord test = good("D2-0.70-s1");
    for (Observation& row : test.rows) lie(row);
    return message(test);
  };
  EXPECT_NE(said([](Observation& o) { o.P_star /= 1000; }).find("1000 times too small: are the units right?"),
            std::string::npos);
  EXPECT_NE(said([](Observation& o) { o.s_par *= -1; }).find("column 's_par': is -"), std::string::npos);
  EXPECT_NE(said([](Observation& o) { o.eps_dev *= 100; }).find("per cent"), std::string::npos);
  EXPECT_NE(said([](Observation& o) { o.C *= 1.1; }).find("column 'C': is "), std::string::npos);
}

}  // namespace
}  // namespace grainlaw
