#include "fit/data_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/error.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kConsistency = 1e-6;  // relative; what two columns of one row may differ by through rounding in a file

[[noreturn]] void refuse(const TestRecord& test, const std::string& why) {
  throw InvalidInput(fmt::format("test {}: {}", test.name, why));
}

void check_row(const TestRecord& test, std::size_t number) {
  const Observation& row = test.rows[number];
  const auto finite = [&](double value, const std::string& column) {
    if (!std::isfinite(value)) {
      refuse(test, fmt::format("row {}, column {} is {}; remove the row or repeat the test", number, column, value));
    }
  };
  for (std::size_t c = 0; c < kComponentIndex.size(); ++c) {
    const auto [i, j] = kComponentIndex[c];
    finite(row.strain.tensor(i, j), std::string("strain_") + kComponentName[c]);
    finite(row.stress.tensor(i, j), std::string("stress_") + kComponentName[c]);
    finite(row.fabric.tensor(i, j), std::string("fabric_") + kComponentName[c]);
  }
  finite(row.nu, "nu");
  finite(row.P_star, "P_star");
  if (!(row.nu > 0)) refuse(test, fmt::format("row {}, column nu is {}; it must be positive", number, row.nu));

  const auto agree = [&](double stated, double computed, const char* column, const char* source) {
    if (std::abs(stated - computed) > kConsistency * std::max(std::abs(stated), std::abs(computed))) {
      refuse(test, fmt::format("row {}, column {} is {:.9g} but {} gives {:.9g}; columns swapped or units changed?",
                               number, column, stated, source, computed));
    }
  };
  agree(row.P_star, row.stress.tensor.trace() / 3 / test.packing.stress_unit(), "P_star", "the stress");
  const Observation& first = test.rows.front();
  const double eps_vol = row.strain.tensor.trace() - first.strain.tensor.trace();
  agree(row.nu, first.nu * std::exp(-eps_vol), "nu", "the strain");
  if (!std::isnan(row.F_v)) agree(row.F_v, row.fabric.tensor.trace(), "F_v", "the fabric");
}

void check_test(const TestRecord& test) {
  if (test.role != Role::calibration) {
    refuse(test, "its role is validation; the calibration must not see it, leave it out");
  }
  if (test.path.segments.empty()) refuse(test, "its path has no segments");
  if (test.rows.size() < 2) refuse(test, fmt::format("it has {} rows; at least 2 are needed", test.rows.size()));
  if (!(test.packing.mean_radius > 0) || !(test.packing.stiffness > 0) || !std::isfinite(test.packing.stress_unit())) {
    refuse(test, fmt::format("mean_radius {} and stiffness {} must be positive", test.packing.mean_radius,
                             test.packing.stiffness));
  }
  for (std::size_t i = 0; i < test.rows.size(); ++i) check_row(test, i);
  const int last = static_cast<int>(test.path.segments.size()) - 1;
  for (std::size_t i = 0; i < test.rows.size(); ++i) {
    const int segment = test.rows[i].segment;
    if (segment < (i == 0 ? 0 : test.rows[i - 1].segment) || segment > last) {
      refuse(test, fmt::format("row {}, column segment is {}; it must grow from 0 to {}", i, segment, last));
    }
  }
}

bool same_series(const TestRecord& a, const TestRecord& b) {
  return a.rows.size() == b.rows.size() && a.rows.back().P_star != 0 &&  // unjammed tests may well agree
         std::equal(a.rows.begin(), a.rows.end(), b.rows.begin(), [](const Observation& x, const Observation& y) {
           return x.stress.tensor == y.stress.tensor && x.strain.tensor == y.strain.tensor;
         });
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

DataSet check_and_sort(const std::vector<TestRecord>& tests) {
  DataSet data;
  std::set<std::string> names;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const TestRecord& test = tests[i];
    check_test(test);
    if (!names.insert(test.name).second) refuse(test, "this name is given twice; rename one of the tests");
    for (std::size_t j = 0; j < i; ++j) {
      if (same_series(test, tests[j])) {
        refuse(test, "holds the same series as test " + tests[j].name + "; counting it twice would halve the errors");
      }
    }
    if (is_isotropic_unloading(test))
      data.isotropic.push_back(&test);
    else if (is_pure_shear(test))
      data.pure_shear.push_back(&test);
    else if (shears(test))
      data.other.push_back(&test);
    else
      data.unused.push_back(test.name);
  }
  if (data.isotropic.empty()) {
    throw InvalidInput("calibration: no test is an isotropic unloading; add {\"mode\": \"ISO\"} to the tests");
  }
  if (data.pure_shear.empty()) {
    throw InvalidInput("calibration: no test is a shear at constant volume; add {\"mode\": \"D2\"} to the tests");
  }
  return data;
}

int cluster_of(const DataSet& data, const TestRecord& test) {
  const auto all = data.all_used();
  const auto same_state = [&](const TestRecord* other) {
    return other->packing.seed == test.packing.seed && other->path.branch == test.path.branch &&
           std::abs(other->rows.front().nu - test.rows.front().nu) < 1e-6;
  };
  return static_cast<int>(std::find_if(all.begin(), all.end(), same_state) - all.begin());
}

}  // namespace grainlaw::fit
