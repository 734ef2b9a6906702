#include "chain/rehearsals.hpp"

#include <gtest/gtest.h>

#include "tests/support/law_path.hpp"

namespace grainlaw::chain {
namespace {

DatasetTest test_of(const std::string& name, Role role, Mode mode, std::uint64_t seed, std::int64_t particles) {
  DatasetTest test{};
  test.record.name = name;
  test.record.role = role;
  test.record.path = {0.7, Branch::unloading, {testing::leg(mode, 0.1)}};
  test.record.packing = {.seed = seed, .particles = particles, .size_width = 3, .mean_radius = 1e-3, .stiffness = 1e8};
  return test;
}

TEST(Rehearsals, AreByPathAndKnowWhetherTheirPackingsWereFitted) {
  Dataset dataset;
  dataset.tests = {test_of("D2-0.7-s1", Role::calibration, Mode::D2, 1, 1000),
                   test_of("UNI-0.7-s2", Role::rehearsal, Mode::UNI, 2, 1000),  // two of others
                   test_of("UNI-0.7-s3", Role::rehearsal, Mode::UNI, 3, 1000),
                   test_of("D3-0.7-s2", Role::rehearsal, Mode::D3, 2, 1000),  // one of others, one that was fitted
                   test_of("D3-0.7-s1", Role::rehearsal, Mode::D3, 1, 1000),
                   test_of("ISO-0.7-s1", Role::rehearsal, Mode::ISO, 1, 2000)};  // of the same seed, but another
  const std::vector<predict::RehearsalRuns> paths = rehearsals_of(dataset, "no such folder");
  ASSERT_EQ(paths.size(), 3u);
  for (const auto& [k, name, runs, fitted] :
       {std::tuple{std::size_t{0}, "UNI-0.7", 2, false}, {1, "D3-0.7", 2, true}, {2, "ISO-0.7", 1, false}}) {
    EXPECT_EQ(paths[k].name, name);
    EXPECT_EQ(paths[k].runs.size(), runs) << name;
    EXPECT_EQ(paths[k].fitted_packings, fitted) << name;
  }
}

}  // namespace
}  // namespace grainlaw::chain
