#include "fit/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "fit/data/data_set.hpp"
#include "fit/data/outliers.hpp"
#include "fit/data/packing_scatter.hpp"
#include "fit/staged_laws.hpp"
#include "fit/stages/density_law_fit.hpp"
#include "fit/stages/evolution_fit.hpp"
#include "fit/stages/lode_fit.hpp"
#include "fit/stages/memory_fit.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kLeastParticles = 4000;  // of a packing, below which its size is seen in the parameters

/// Laws of Eq. (20) of which not one shear test says anything.
std::vector<std::string> unseen_laws(const std::vector<ShearFit>& shear) {
  std::vector<std::string> names;
  for (const ShearQuantity& quantity : kShearQuantities) {
    const bool seen = std::ranges::any_of(
        shear, [&](const ShearFit& fit) { return (fit.*quantity.estimate).status != Status::not_identified; });
    if (!seen) names.push_back(quantity.name);
  }
  return names;
}

void set_anisotropy(const std::vector<Trajectory>& trajectories, Calibration& calibration,
                    const CalibrationOptions& options) {
  const auto estimate = [&](const char* name) -> Estimate& { return calibration.law.estimates[parameter_index(name)]; };
  if (options.coupling == Coupling::energy) {
    estimate("anisotropy.a0") = {0, kUndefined, Status::not_identified, "not part of the law with coupling energy"};
    const auto i = static_cast<Eigen::Index>(parameter_index("anisotropy.a1"));
    const auto j = static_cast<Eigen::Index>(parameter_index("anisotropy.a2"));
    const TiedCoupling tied = tied_a1(trajectories, calibration.law.parameters, estimate("anisotropy.a2"),
                                      calibration.errors.influence.row(j), options);
    estimate("anisotropy.a1") = tied.a1;
    if (tied.a1.status == Status::tied) calibration.law.parameters.anisotropy.a1 = tied.a1.value;
    calibration.errors.influence.row(i) = tied.influence;
    calibration.errors.degrees_of_freedom(i) = tied.a1.degrees_of_freedom;
  } else {
    estimate("anisotropy.a1") = {0, kUndefined, Status::not_identified, "not part of the law with coupling single"};
    estimate("anisotropy.a2") = {0, kUndefined, Status::not_identified, "not part of the law with coupling single"};
  }
}

/// Those that can be followed with their fabric: of tests that tell it, and isotropic ones.
std::vector<Trajectory> with_fabric(std::vector<Trajectory> trajectories) {
  std::erase_if(trajectories, [](const Trajectory& t) { return !t.start.F.allFinite(); });
  return trajectories;
}

bool any_sheared(const std::vector<Trajectory>& trajectories) {
  return std::ranges::any_of(trajectories, [](const Trajectory& t) { return !t.axes.empty(); });
}

void fix_by_decision(CalibratedLaw& law) {
  for (const auto& [name, value] :
       {std::pair{"memory.m", law.parameters.memory.m}, {"memory.a_P", law.parameters.memory.a_P}})
    law.estimates[parameter_index(name)] = {value, kUndefined, Status::fixed, "by docs/decisions/0005-memory-law.md"};
}

/// Stages 4 to 6 of data that tell no fabric: none of it can be said, and the laws of the stages before stand.
void leave_out_fabric(Calibration& calibration, const CalibrationOptions& options, const RunControl& control) {
  run(left_out("evolution", parameters_of("anisotropy"), kAddFabric), calibration, options, control);
  run(no_lode(std::string("taken as none: ") + kAddFabric), calibration, options, control);
  run(no_memory(kAddFabric), calibration, options, control);
}

/// The stage of the memory rung, or why there is none.
StageDefinition memory_rung(const std::vector<Trajectory>& trajectories, const Calibration& calibration,
                            const CalibrationOptions& options) {
  for (const char* group :
       {"steady_coordination", "steady_rattlers", "steady_pressure", "stress_ratio_max", "fabric_max"}) {
    if (has_values(calibration.law, group)) continue;
    return no_memory(std::string(group) + " is not identified; shear by D2 at more densities, to steady state");
  }
  return memory_stage(trajectories, options);
}

ValidRange range_of(const std::vector<Trajectory>& trajectories, const DataSet& data) {
  ValidRange range{1, 0, 0, 0, 0};
  for (const TestRecord* test : data.all_used()) {
    for (const Observation& row : test->rows) range.shear_path_max = std::max(range.shear_path_max, row.shear_path);
  }
  for (const Trajectory& t : trajectories) {
    if (t.rows.empty()) continue;
    const double e = t.rows.back().e;
    range.nu_min = std::min({range.nu_min, t.nu_start, t.nu(e)});
    range.nu_max = std::max({range.nu_max, t.nu_start, t.nu(e)});
    range.eps_dev_max = std::max({range.eps_dev_max, t.eps_dev(0), t.eps_dev(e)});
    range.eps_vol_max = std::max({range.eps_vol_max, std::abs(t.eps_vol(0)), std::abs(t.eps_vol(e))});
  }
  return range;
}

/// The law's errors by the prior, and what is to be said of them.
void moderate_errors(const CalibrationOptions& options, Calibration& calibration) {
  CalibratedLaw& law = calibration.law;
  const PackingCount& size = calibration.size;
  if (options.prior) {
    const Moderation& done = calibration.moderation = moderate(*options.prior, size, law);
    if (done.parameters == 0 && done.ratio > 0)
      calibration.warnings.push_back(
          fmt::format("the prior of the errors is not used: our variances are {:.2g} times what it expects, where "
                      "{:.2g} could be chance; errors are those of {} packings alone",
                      done.ratio, done.ratio > 1 ? done.largest_ratio : 1 / done.largest_ratio, size.packings));
  }
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    if (says_nothing(law, i)) law.estimates[i].note = fmt::format("not determined by {} packings", size.packings);
  }
  if (std::isnan(size.spheres))
    calibration.warnings.push_back(
        fmt::format("packings do not all say their `particles`: errors are those of {} packings alone, not moderated "
                    "by a prior, and what their size biases is not known",
                    size.packings));
  if (size.spheres < kLeastParticles * static_cast<double>(size.packings))
    calibration.warnings.push_back(
        fmt::format("packings of {:.0f} spheres: what a size below {:.0f} biases is in no interval (jamming "
                    "densities first: docs/theory/fit.md, Moderated variances)",
                    size.spheres / size.packings, kLeastParticles));
}

/// Where a stage lies in the whole fit by its usual share of the time, of which the coupled stages take nearly all.
std::pair<double, double> share_of(const std::string& stage) {
  if (stage == "evolution") return {0.05, 0.6};
  if (stage == "lode") return {0.6, 0.62};
  if (stage == "memory") return {0.62, 1};
  return {0, 0.05};
}

/// `control`, told how far the fit is as a whole: never back, within a stage by its iterations.
RunControl of_whole(const RunControl& control) {
  constexpr double kIterations = 15;  // after which half of a stage is taken as done
  if (!control.report) return control;
  const auto tell = [report = control.report, so_far = std::make_shared<double>(0)](Progress progress) {
    const auto [begin, end] = share_of(progress.stage);
    const double fraction = begin + (end - begin) * progress.work / (progress.work + kIterations);
    progress.fraction = *so_far = std::max(*so_far, fraction);
    report(progress);
  };
  return {tell, control.stop};
}

}  // namespace

PackingCount size_of(const std::vector<TestRecord>& tests) {
  std::map<std::uint64_t, double> spheres;
  for (const TestRecord& test : tests) {
    double& count = spheres[test.packing.seed];
    count = std::max(count, static_cast<double>(test.packing.particles));
  }
  PackingCount size{static_cast<int>(spheres.size()), 0};
  for (const auto& [seed, count] : spheres) size.spheres += count > 0 ? count : kUndefined;
  return size;
}

Calibration calibrate(const std::vector<TestRecord>& tests, const CalibrationOptions& options,
                      const RunControl& run_control) {
  check(options);
  const RunControl control = of_whole(run_control);
  const DataSet data = check_and_sort(tests);
  Calibration calibration = nothing_known();
  calibration.law.coupling = options.coupling;
  calibration.unused_tests = data.unused;
  calibration.warnings = outlier_warnings(data, options);
  std::ranges::move(packing_warnings(data), std::back_inserter(calibration.warnings));
  const std::vector<DensitySeries> unloading = isotropic_series(data, options);
  fit_unloading_laws("ISO unloading", unloading, calibration, options, control);
  fit_steady_laws(Mode::D2, data, calibration, options, control);
  fit_shear_laws(data, calibration, options, control);
  const std::vector<Trajectory> trajectories =
      trajectories_of(data, calibration.law.parameters.isotropic.pressure.nu_c, options);
  fix_by_decision(calibration.law);
  if (any_sheared(with_fabric(trajectories))) {
    const ByLodeAngle sheared = by_lode_angle(with_fabric(trajectories));
    run(evolution_stage(sheared.reference, unseen_laws(calibration.shear), options), calibration, options, control);
    set_anisotropy(sheared.reference, calibration, options);
    run(lode_stage(sheared.others, options), calibration, options, control);
    run(memory_rung(sheared.reference, calibration, options), calibration, options, control);
  } else {
    leave_out_fabric(calibration, options, control);
  }
  fit_overlap_law("ISO unloading", unloading, calibration, options, control);
  calibration.law.covariance = calibration.errors.covariance();
  calibration.size = size_of(tests);
  moderate_errors(options, calibration);
  tie_errors(calibration.law);
  calibration.law.scatter = packing_scatter(data, calibration.law.parameters, options.iso_nu_min);
  calibration.law.range = range_of(trajectories, data);
  calibration.law.converged = all_converged(calibration);
  forget_unknown_fabric(calibration.law);
  for (std::string& line : left_out_rungs(calibration.law)) calibration.warnings.push_back(std::move(line));
  return calibration;
}

}  // namespace grainlaw::fit
