#include "fit/describe.hpp"

#include <algorithm>
#include <set>

#include "fit/data/data_set.hpp"
#include "fit/data/density_series.hpp"
#include "fit/staged_laws.hpp"

namespace grainlaw::fit {
namespace {

constexpr std::size_t kPointsNeeded = 4;  // Eq. (14) has three parameters

bool is_uniaxial(const TestRecord& test) {
  return std::all_of(test.path.segments.begin(), test.path.segments.end(),
                     [](const PathSegment& segment) { return segment.mode == Mode::UNI; });
}

/// What is said of `name` once its stages have run.
Description finished(const std::string& name, Calibration calibration, const std::vector<const TestRecord*>& tests) {
  std::set<std::uint64_t> seeds;
  for (const TestRecord* test : tests) seeds.insert(test->packing.seed);
  calibration.size.packings = static_cast<int>(seeds.size());
  calibration.law.covariance = calibration.errors.covariance();
  calibration.law.converged = all_converged(calibration);
  return {name, std::move(calibration)};
}

}  // namespace

std::vector<Description> describe(const std::vector<TestRecord>& tests, double nu_c, const CalibrationOptions& options,
                                  const RunControl& control) {
  check(options);
  const DataSet data = check_and_sort(tests, Role::description);
  std::vector<Description> all;

  std::vector<const TestRecord*> uniaxial;
  std::copy_if(data.other.begin(), data.other.end(), std::back_inserter(uniaxial),
               [](const TestRecord* test) { return is_uniaxial(*test); });
  const std::vector<DensitySeries> series = unloading_series(uniaxial, data, options);
  std::size_t points = 0;
  for (const DensitySeries& s : series) points += s.points.size();
  if (points >= kPointsNeeded) {
    Calibration calibration = nothing_known();
    fit_unloading_laws("UNI unloading", series, calibration, options, control);
    fit_overlap_law("UNI unloading", series, calibration, options, control);
    calibration.law.range.nu_min = least_nu(series);
    for (const DensitySeries& s : series) {
      for (const DensityPoint& p : s.points)
        calibration.law.range.nu_max = std::max(calibration.law.range.nu_max, p.nu);
    }
    all.push_back(finished("UNI", std::move(calibration), uniaxial));
  }

  for (const Mode mode : {Mode::D2, Mode::D3}) {
    for (const Branch branch : {Branch::unloading, Branch::loading}) {
      DataSet part = data;
      std::erase_if(part.pure_shear, [&](const TestRecord* test) {
        return test->path.segments.front().mode != mode || test->path.branch != branch;
      });
      if (part.pure_shear.empty()) continue;
      Calibration calibration = nothing_known();
      calibration.law.parameters.isotropic.pressure.nu_c = nu_c;
      fit_steady_laws(mode, part, calibration, options, control);
      fit_shear_laws(part, calibration, options, control);
      const auto [least, most] = std::minmax_element(calibration.shear.begin(), calibration.shear.end(),
                                                     [](const ShearFit& a, const ShearFit& b) { return a.nu < b.nu; });
      calibration.law.range.nu_min = least->nu;
      calibration.law.range.nu_max = most->nu;
      all.push_back(finished(to_string(mode) + (branch == Branch::loading ? "-loading" : ""), std::move(calibration),
                             part.pure_shear));
    }
  }
  return all;
}

}  // namespace grainlaw::fit
