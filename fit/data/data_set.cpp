#include "fit/data/data_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kConsistency = 1e-6;  // relative; what two columns of one row may differ by through rounding in a file
constexpr double kRounding = 1e-9;     // absolute, of numbers of order one that may vanish
constexpr double kOffPath = 1e-3;      // strain by which a run may miss its path
constexpr double kImplausible = 3;     // factor by which a mean-field estimate may be off before units are suspected
constexpr double kMeanFieldPressure = 0.87 / (2 * std::numbers::pi);  // P* over nu C <delta>/<r> at w = 3
constexpr double kLeastPressure = 1e-4;                               // P* below which ratios to it say little
constexpr double kSurelyJammed = 1e-3;  // P* from which so many contacts carry that a mean field holds
constexpr double kMeanFieldFabric = 1.22;

/// One row of a test, and what to say when it cannot be.
class CheckedRow {
 public:
  CheckedRow(const TestRecord& test, std::size_t number) : test_(test), number_(number), row_(test.rows[number]) {}

  void check(const Deviator<double>& N, const std::vector<StraightSegment>& path) const {
    check_finite();
    check_relations(N);
    check_plausibility();
    check_place(path);
  }

 private:
  [[noreturn]] void refuse(const std::string& column, const std::string& why) const {
    throw InvalidInput(fmt::format("test {}: row {}, column {} {}", test_.name, number_, column, why));
  }

  void finite(double value, const std::string& column) const {
    if (!std::isfinite(value)) refuse(column, fmt::format("is {}; remove the row or repeat the test", value));
  }

  void check_finite() const {
    for (std::size_t c = 0; c < kComponentIndex.size(); ++c) {
      const auto [i, j] = kComponentIndex[c];
      finite(row_.strain.tensor(i, j), std::string("strain_") + kComponentName[c]);
      finite(row_.stress.tensor(i, j), std::string("stress_") + kComponentName[c]);
      finite(row_.fabric.tensor(i, j), std::string("fabric_") + kComponentName[c]);
    }
    finite(row_.nu, "nu");
    finite(row_.P_star, "P_star");
    if (!(row_.nu > 0)) refuse("nu", fmt::format("is {}; it must be positive", row_.nu));
  }

  /// `floor`: absolute difference that is none.
  void agree(double stated, double computed, const char* column, const char* source, double floor) const {
    if (std::isnan(stated) || std::isnan(computed)) return;  // undefined
    if (std::abs(stated - computed) <= kConsistency * std::max(std::abs(stated), std::abs(computed)) + floor) return;
    refuse(column,
           fmt::format("is {:.9g} but {} gives {:.9g}; columns swapped or units changed?", stated, source, computed));
  }

  void check_relations(const Deviator<double>& N) const {
    const Observation& first = test_.rows.front();
    agree(row_.P_star, row_.stress.tensor.trace() / 3 / test_.packing.stress_unit(), "P_star", "the stress", 0);
    const double volume = row_.strain.tensor.trace();
    agree(row_.nu, first.nu * std::exp(first.strain.tensor.trace() - volume), "nu", "the strain", 0);
    agree(row_.eps_vol, volume, "eps_vol", "the strain", kRounding);
    agree(row_.eps_dev, deviatoric_norm(row_.strain.tensor), "eps_dev", "the strain", kRounding);
    agree(row_.F_v, row_.fabric.tensor.trace(), "F_v", "the fabric", 0);
    agree(row_.F_dev, deviatoric_norm(row_.fabric.tensor), "F_dev", "the fabric", kRounding);
    agree(row_.C, (1 - row_.rattler_fraction) * row_.C_star, "C", "(1 - rattler_fraction) C_star", kRounding);
    if (!N.isZero()) agree(row_.F_par, deviator<double>(row_.fabric.tensor).dot(N), "F_par", "the fabric", kRounding);
    const double P = row_.stress.tensor.trace() / 3;
    if (!(row_.P_star > kLeastPressure)) return;
    agree(row_.s_dev, deviatoric_norm(row_.stress.tensor) / P, "s_dev", "the stress", kRounding);
    if (!N.isZero())
      agree(row_.s_par, deviator<double>(row_.stress.tensor).dot(N) / P, "s_par", "the stress", kRounding);
  }

  /// Not judged where both are below `least`.
  void plausible(double stated, double expected, double least, const char* column, const char* source) const {
    if (!std::isfinite(expected) || !(std::max(stated, expected) > least)) return;
    if (stated > expected / kImplausible && stated < expected * kImplausible) return;
    refuse(column, fmt::format("is {:.4g}, but {} make one expect some {:.2g}; are units or columns mistaken?", stated,
                               source, expected));
  }

  void check_plausibility() const {
    const double C = (1 - row_.rattler_fraction) * row_.C_star;
    plausible(row_.P_star, kMeanFieldPressure * row_.nu * C * row_.mean_overlap, kSurelyJammed, "P_star",
              "volume fraction, coordination and mean overlap");
    if (!(row_.P_star > kSurelyJammed)) return;  // before, most contacts are those of rattlers, which C leaves out
    plausible(row_.fabric.tensor.trace(), kMeanFieldFabric * row_.nu * C, 0, "F_v", "volume fraction and coordination");
  }

  void check_place(const std::vector<StraightSegment>& path) const {
    const int last = static_cast<int>(path.size()) - 1;
    const int before = number_ == 0 ? 0 : test_.rows[number_ - 1].segment;
    if (row_.segment < before || row_.segment > last) {
      refuse("segment", fmt::format("is {}; it must grow from 0 to {}", row_.segment, last));
    }
    const StraightSegment& segment = path[static_cast<std::size_t>(row_.segment)];
    const Eigen::Matrix3d& D = segment.direction.tensor;
    const Eigen::Matrix3d since = row_.strain.tensor - test_.rows.front().strain.tensor - segment.strain_start.tensor;
    const double e = std::clamp(since.cwiseProduct(D).sum() / D.squaredNorm(), 0.0, segment.length);
    if (const double off = (since - e * D).norm(); off > kOffPath) {
      refuse("strain", fmt::format("is {:.3g} off segment {} of the test's path; columns swapped, or in per cent?", off,
                                   row_.segment));
    }
  }

  const TestRecord& test_;
  std::size_t number_;
  const Observation& row_;
};

/// Columns that are undefined where that is allowed are not judged; strain, nu, stress, P_star and fabric must be finite.
void check_rows(const TestRecord& test) {
  const std::vector<StraightSegment> path = resolve(test.path);
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (!path[k].spin.isZero(0)) {
      throw InvalidInput(
          fmt::format("test {}: segments[{}] spins, and the fit's laws know no rotation; give the test another role "
                      "than calibration, its strain as a rate_tensor, or predict it",
                      test.name, k));
    }
  }
  const Deviator<double> N = shear_direction(path);
  for (std::size_t i = 0; i < test.rows.size(); ++i) CheckedRow(test, i).check(N, path);
}

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
  check_rows(test);
}

bool same_series(const TestRecord& a, const TestRecord& b) {
  const auto carries = [](const Observation& row) { return row.P_star != 0; };  // unjammed tests may well agree
  return a.rows.size() == b.rows.size() && std::any_of(a.rows.begin(), a.rows.end(), carries) &&
         std::equal(a.rows.begin(), a.rows.end(), b.rows.begin(), [](const Observation& x, const Observation& y) {
           return x.stress.tensor == y.stress.tensor && x.strain.tensor == y.strain.tensor;
         });
}

/// Six doubles that no two packings have in common by chance.
using StressKey = std::array<double, 6>;
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
                       i, at->second.row, other.name));
  }
}

bool shears(const TestRecord& test) {
  return std::any_of(test.path.segments.begin(), test.path.segments.end(), [](const PathSegment& s) {
    return deviatoric_norm(s.direction.tensor) > 1e-12 * s.direction.tensor.norm();
  });
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
    else if (shears(test))
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

int packing_of(const DataSet& data, const TestRecord& test) {
  std::set<std::uint64_t> seeds;
  for (const TestRecord* used : data.all_used()) seeds.insert(used->packing.seed);
  return static_cast<int>(std::distance(seeds.begin(), seeds.find(test.packing.seed)));
}

}  // namespace grainlaw::fit
