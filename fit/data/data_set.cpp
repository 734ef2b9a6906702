#include "fit/data/data_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "model/vocabulary/error.hpp"
#include "model/vocabulary/series_check.hpp"

namespace grainlaw::fit {
namespace {

[[noreturn]] void refuse(const TestRecord& test, const std::string& why) {
  throw InvalidInput(fmt::format("test {}: {}", test.name, why));
}

void check_test(const TestRecord& test, Role role) {
  if (test.role != role) {
    refuse(test,
           fmt::format("its role is {}; the {} must not see it, leave it out", to_string(test.role), to_string(role)));
  }
  if (test.path.segments.empty()) refuse(test, "its path has no segments");
  if (test.rows.size() < 2) refuse(test, fmt::format("it has {} rows; at least 2 are needed", test.rows.size()));
  if (!(test.packing.mean_radius > 0) || !(test.packing.stiffness > 0) || !std::isfinite(test.packing.stress_unit())) {
    refuse(test, fmt::format("mean_radius {} and stiffness {} must be positive", test.packing.mean_radius,
                             test.packing.stiffness));
  }
  for (std::size_t k = 0; k < test.path.segments.size(); ++k) {
    if (!test.path.segments[k].spin.isZero(0)) {
      refuse(test,
             fmt::format("segments[{}] spins, and the fit's laws know no rotation; give the test another role than "
                         "calibration, its strain as a rate_tensor, or predict it",
                         k));
    }
  }
  check_series(test.rows, test.path, test.packing, "test " + test.name);
}

/// Refuses what is not of the material of `first`.
void check_material(const TestRecord& test, const TestRecord& first) {
  const std::string differs = other_material(test.packing, first.packing);
  if (!differs.empty())
    refuse(test, fmt::format("{} in test {}; a law is of one material, calibrate them apart", differs, first.name));
}

bool same_series(const TestRecord& a, const TestRecord& b) {
  const auto carries = [](const Observation& row) { return row.P_star != 0; };  // unjammed tests may well agree
  return a.rows.size() == b.rows.size() && std::any_of(a.rows.begin(), a.rows.end(), carries) &&
         std::ranges::equal(a.rows, b.rows, [](const Observation& x, const Observation& y) {
           return x.stress.tensor == y.stress.tensor && x.strain.tensor == y.strain.tensor;
         });
}

/// Six doubles that no two packings have in common by chance.
using StressKey = std::array<double, 6>;
constexpr double kSameSize = 1e-4;  // of the mean radius of a packing as two files say it

struct Place {
  const TestRecord* test;
  std::size_t row;
};

StressKey key_of(const Observation& row) {
  StressKey key;
  for (std::size_t c = 0; c < kComponentIndex.size(); ++c) {
    key[c] = row.stress.tensor(kComponentIndex[c][0], kComponentIndex[c][1]);
  }
  return key;
}

/// Refuses rows that stand in runs of two packings. Runs of one packing may well go the same way for a while.
void check_independence(const TestRecord& test, std::map<StressKey, Place>& seen) {
  for (std::size_t i = 0; i < test.rows.size(); ++i) {
    if (!(test.rows[i].P_star > 0)) continue;
    const auto [at, fresh] = seen.try_emplace(key_of(test.rows[i]), Place{&test, i});
    const TestRecord& other = *at->second.test;
    if (fresh || test.packing.seed == other.packing.seed) continue;
    refuse(test,
           fmt::format("row {} has the stress of row {} of test {} to the last digit, although their seeds differ; "
                       "counting one run twice would make the errors too small, leave one out",
                       i + 1, at->second.row + 1, other.name));
  }
}

/// Refuses two packings of one seed, which would count as one.
void check_packing(const TestRecord& test, const TestRecord& other) {
  const PackingInfo &a = test.packing, &b = other.packing;
  const auto differ = [](double x, double y) { return x > 0 && y > 0 && std::abs(x - y) > kSameSize * std::max(x, y); };
  if (a.seed != b.seed || (!differ(a.mean_radius, b.mean_radius) &&
                           !differ(static_cast<double>(a.particles), static_cast<double>(b.particles))))
    return;
  refuse(test,
         fmt::format(
             "seed {} is that of test {}, too, but the packing is another: {} spheres of mean radius {} m, there {} "
             "of {} m; give each packing a seed of its own",
             a.seed, other.name, a.particles, a.mean_radius, b.particles, b.mean_radius));
}

}  // namespace

std::vector<const TestRecord*> DataSet::all_used() const {
  std::vector<const TestRecord*> all(isotropic);
  all.insert(all.end(), pure_shear.begin(), pure_shear.end());
  all.insert(all.end(), other.begin(), other.end());
  return all;
}

DataSet check_and_sort(const std::vector<TestRecord>& tests, Role role) {
  DataSet data;
  std::set<std::string> names;
  std::map<StressKey, Place> seen;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const TestRecord& test = tests[i];
    check_test(test, role);
    for (std::size_t j = 0; j < i; ++j)
      check_material(test, tests[j]), check_packing(test, tests[j]);  // those that do not tell agree with all
    if (!names.insert(test.name).second) refuse(test, "this name is given twice; rename one of the tests");
    for (std::size_t j = 0; j < i; ++j) {
      if (same_series(test, tests[j])) {
        refuse(test, "holds the same series as test " + tests[j].name + "; counting it twice would halve the errors");
      }
    }
    check_independence(test, seen);
    if (is_isotropic_unloading(test))
      data.isotropic.push_back(&test);
    else if (is_pure_shear(test))
      data.pure_shear.push_back(&test);
    else if (std::ranges::any_of(test.path.segments, shears, &PathSegment::direction))
      data.other.push_back(&test);
    else
      data.unused.push_back(test.name);
  }
  if (role != Role::calibration) return data;
  if (data.isotropic.empty()) {
    throw InvalidInput("calibration: no test is an isotropic unloading; add {\"mode\": \"ISO\"} to the tests");
  }
  if (data.pure_shear.empty()) {
    throw InvalidInput("calibration: no test is a shear at constant volume; add {\"mode\": \"D2\"} to the tests");
  }
  return data;
}

bool tells_fabric(const TestRecord& test) {
  return std::ranges::any_of(test.rows, [](const Observation& row) { return row.fabric.tensor.allFinite(); });
}

bool counts_contacts(const TestRecord& test) {
  const auto any = [&](double Observation::*value) {
    return std::ranges::any_of(test.rows, [value](const Observation& row) { return !std::isnan(row.*value); });
  };
  return any(&Observation::C_star) && any(&Observation::rattler_fraction);
}

int packing_of(const DataSet& data, const TestRecord& test) {
  std::set<std::uint64_t> seeds;
  for (const TestRecord* used : data.all_used()) seeds.insert(used->packing.seed);
  return static_cast<int>(std::distance(seeds.begin(), seeds.find(test.packing.seed)));
}

}  // namespace grainlaw::fit
