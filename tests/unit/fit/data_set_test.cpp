#include "fit/data/data_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

std::vector<TestRecord> small_set() {
  testing::SyntheticOptions options;
  options.densities = {0.70};
  options.seeds = {1};
  options.rows = 12;
  return testing::synthetic_dataset(testing::synthetic_truth(), options);
}

std::string refusal_of_tests(const std::vector<TestRecord>& tests) {
  try {
    check_and_sort(tests);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

void expect_refusal(const std::vector<TestRecord>& tests, const std::vector<std::string>& words) {
  const std::string message = refusal_of_tests(tests);
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(DataSet, SortsByWhatATestCanSay) {
  const std::vector<TestRecord> tests = small_set();
  const DataSet data = check_and_sort(tests);
  ASSERT_EQ(data.isotropic.size(), 1u);
  ASSERT_EQ(data.pure_shear.size(), 1u);
  ASSERT_EQ(data.other.size(), 1u);
  EXPECT_EQ(data.isotropic[0], &tests[0]);
  EXPECT_EQ(data.pure_shear[0], &tests[1]);
  EXPECT_EQ(data.other[0], &tests[2]);
  EXPECT_TRUE(data.unused.empty());
}

TEST(DataSet, IsotropicLoadingIsKnownAndNotUsed) {
  std::vector<TestRecord> tests = small_set();
  TestRecord loading = tests[0];  // the other way round
  loading.name = "iso-loading";
  std::reverse(loading.rows.begin(), loading.rows.end());
  loading.path = {
      loading.rows.front().nu, Branch::loading, {testing::synthetic_segment(Mode::ISO, ExtentKind::target_nu, 0.82)}};
  const Eigen::Matrix3d first = loading.rows.front().strain.tensor;
  for (Observation& row : loading.rows) {
    row.strain.tensor -= first;
    row.eps_vol = row.strain.tensor.trace();
  }
  tests.push_back(loading);
  EXPECT_EQ(check_and_sort(tests).unused, std::vector<std::string>{"iso-loading"});
}

TEST(DataSet, RunsOfOneSeedAreOnePacking) {
  testing::SyntheticOptions options;
  options.densities = {0.70, 0.74};
  options.rows = 8;
  const std::vector<TestRecord> tests = testing::synthetic_dataset(testing::synthetic_truth(), options);
  const DataSet data = check_and_sort(tests);
  for (const TestRecord& a : tests) {
    EXPECT_LT(packing_of(data, a), 2);
    for (const TestRecord& b : tests) {
      EXPECT_EQ(packing_of(data, a) == packing_of(data, b), a.packing.seed == b.packing.seed)
          << a.name << " " << b.name;
    }
  }
}

TEST(DataSet, RefusesWhatItMustNotSee) {
  std::vector<TestRecord> tests = small_set();
  tests[1].role = Role::validation;
  expect_refusal(tests, {tests[1].name, "validation"});
}

TEST(DataSet, RefusesMissingTestsWithTheRemedy) {
  const std::vector<TestRecord> tests = small_set();
  expect_refusal({tests[1], tests[2]}, {"isotropic unloading", "ISO"});
  expect_refusal({tests[0], tests[2]}, {"constant volume", "D2"});
  expect_refusal({}, {"isotropic unloading"});
}

TEST(DataSet, NamesTestRowAndColumnOfABadNumber) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<TestRecord> tests = small_set();
    tests[1].rows[3].stress.tensor(1, 2) = bad;
    expect_refusal(tests, {tests[1].name, "row 4", "stress_yz"});
    tests = small_set();
    tests[2].rows[5].fabric.tensor(0, 0) = bad;
    expect_refusal(tests, {tests[2].name, "row 6", "fabric_xx"});
    tests = small_set();
    tests[0].rows[0].nu = bad;
    expect_refusal(tests, {tests[0].name, "row 1", "nu"});
  }
}

TEST(DataSet, NoticesUnitsAndSwappedColumns) {
  std::vector<TestRecord> tests = small_set();
  for (Observation& row : tests[1].rows) row.stress.tensor *= 1000;  // kPa read as Pa
  expect_refusal(tests, {tests[1].name, "row 1", "P_star", "units"});
  tests = small_set();
  for (Observation& row : tests[1].rows) std::swap(row.P_star, row.nu);
  expect_refusal(tests, {tests[1].name, "row 1"});
  tests = small_set();
  tests[1].rows[4].nu *= 1.001;
  expect_refusal(tests, {tests[1].name, "row 5", "nu", "strain"});
  tests = small_set();
  tests[1].rows[4].F_v *= 2;
  expect_refusal(tests, {tests[1].name, "row 5", "F_v"});
  tests = small_set();
  for (Observation& row : tests[1].rows) row.mean_overlap *= 1000;  // hard case F7 has the rest
  expect_refusal(tests, {tests[1].name, "row 1", "P_star", "mean overlap", "units"});
}

TEST(DataSet, RefusesSpin) {
  std::vector<TestRecord> tests = small_set();
  tests[1].path.segments[0].spin << 0, -1, 0, 1, 0, 0, 0, 0, 0;
  expect_refusal(tests, {"test " + tests[1].name, "segments[0]", "spins"});
}

TEST(DataSet, NoticesATestGivenTwice) {
  std::vector<TestRecord> tests = small_set();
  tests.push_back(tests[1]);
  expect_refusal(tests, {tests[1].name, "twice"});
  tests.back().name = "another";
  expect_refusal(tests, {"another", tests[1].name, "same series"});
  tests.back().rows.pop_back();
  EXPECT_EQ(refusal_of_tests(tests), "accepted") << "two runs of one packing may go the same way for a while";
  tests.back().packing.seed += 1;
  expect_refusal(tests, {"another", "row 1", tests[1].name, "seeds differ"});
  tests = small_set();
  tests.push_back(tests[0]);  // ends unjammed
  tests.back().name = "another";
  expect_refusal(tests, {"another", tests[0].name, "same series"});
}

TEST(DataSet, RefusesASecondMaterial) {
  const std::vector<TestRecord> tests = small_set();
  std::vector<TestRecord> changed = tests;
  changed[1].packing.contacts.friction = 0.5;
  expect_refusal(changed,
                 {"test " + changed[1].name, "contacts", "hooke, friction 0.5, ", tests[0].name, "one material"});
  for (TestRecord& test : changed) test.packing.contacts.friction = 0.5;
  EXPECT_EQ(refusal_of_tests(changed), "accepted") << "friction is in the data";
  changed = tests;
  changed[2].packing.size_width = 2 * tests[0].packing.size_width;
  expect_refusal(changed, {"test " + changed[2].name, "size_width", tests[0].name});
  changed[2].packing.size_width = 0;
  EXPECT_EQ(refusal_of_tests(changed), "accepted") << "unknown";
  changed = tests;
  changed[0].packing.size_width = 0;
  changed[2].packing.size_width = 2 * tests[1].packing.size_width;
  expect_refusal(changed, {"test " + changed[2].name, "size_width", changed[1].name});
}

TEST(DataSet, RefusesEmptyAndMisshapenTests) {
  std::vector<TestRecord> tests = small_set();
  tests[1].rows.clear();
  expect_refusal(tests, {tests[1].name, "0 rows"});
  tests = small_set();
  tests[1].packing.mean_radius = 0;
  expect_refusal(tests, {tests[1].name, "mean_radius"});
  tests = small_set();
  tests[2].rows[3].segment = 7;
  expect_refusal(tests, {tests[2].name, "row 4", "segment"});
}

TEST(DataSet, RefusesTwoPackingsOfOneSeed) {
  std::vector<TestRecord> tests = small_set();
  TestRecord& last = tests.back();
  last.packing.mean_radius *= 1.01;
  for (Observation& row : last.rows) row.stress.tensor /= 1.01;  // of the same P*
  expect_refusal(tests, {last.name, "seed", "another"});
  tests = small_set();
  for (TestRecord& test : tests) test.packing.particles = 1000;
  tests.back().packing.particles = 0;  // not told
  EXPECT_NO_THROW(check_and_sort(tests));
  tests.back().packing.particles = 1001;
  expect_refusal(tests, {tests.back().name, "seed", "another"});
}

}  // namespace
}  // namespace grainlaw::fit
