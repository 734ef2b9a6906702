#include "chain/planning/planned_spec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/feasibility.hpp"
#include "fit/data/options.hpp"
#include "model/files/path_json.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr std::int64_t kPilotParticles = 400;
constexpr int kPilotPackings = 4;
constexpr int kPilotDensities = 4;         // one more than Eq. (20) has parameters
constexpr double kPilotStrain = 0.3;       // twice where steady means begin
constexpr double kPilotInertia = 2.5e-3;   // inertial number at kTypicalPressure; the paper's 138 1/s has 2.8e-4
constexpr double kTypicalPressure = 0.04;  // P* in the middle of the densities of the paper
constexpr double kLargestStep = 0.1;       // beyond it runs end by their energy balance now and then
constexpr double kRange = 0.08;            // of densities, at least
constexpr double kExcursion = 0.03;        // rise of nu in D2-ISO

/// Strain rate of an inertial number I = rate d sqrt(rho/P) at the typical pressure, P = P* k/d [1/s].
double rate_of(double inertia, const dem::PackingOptions& packing) {
  const double d = 2 * packing.mean_radius, P = kTypicalPressure * packing.material.stiffness / d;
  return inertia / d * std::sqrt(P / packing.material.density);
}

/// `count` values from `low` to `high`, ends included.
std::vector<double> spread(double low, double high, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(std::round(1e3 * (low + (high - low) * i / (count - 1))) / 1e3);
  return values;
}

/// A calibration test as planned; of what is planned not `path` itself, which the law is to be judged by.
void set_test(dem::TestRequest& test, const std::vector<double>& densities, double strain, const Path& path,
              const dem::Spec& frame) {
  if (test.role != Role::calibration) return;
  if (test.mode == "D2" || test.mode == "D3") {
    test.densities = densities;
    test.strain = strain;
  } else if (test.mode == "D2-ISO") {
    test.densities = spread(densities.front(), densities.back() - kExcursion, 3);
  } else {
    return;  // as the frame says
  }
  std::erase_if(test.densities,
                [&](double nu) { return path_to_json(dem::path_of(test, nu, frame)) == path_to_json(path); });
}

}  // namespace

std::vector<double> densities_for(const Path& path, int count, const dem::PreparationOptions& frame) {
  double low = path.nu, high = path.nu;
  for (const StraightSegment& segment : resolve(path)) {
    low = std::min(low, segment.nu(segment.length));
    high = std::max(high, segment.nu(segment.length));
  }
  const double least = std::max(frame.nu_end.value_or(frame.nu_start), fit::CalibrationOptions{}.iso_nu_min);
  const double most = frame.nu_max - 0.01;  // the unloading branch has settled
  if (high - low < kRange) {
    const double middle = (low + high) / 2;
    low = middle - kRange / 2;
    high = middle + kRange / 2;
  }
  low = std::clamp(low, least, std::max(least, most - kRange));
  high = std::clamp(high, std::min(low + kRange, most), most);
  return spread(low, high, count);
}

dem::Spec planned_spec(const dem::Spec& frame, const PlanSettings& settings, const Path& path) {
  dem::Spec planned = frame;
  const std::vector<double> densities = densities_for(path, settings.densities, frame.preparation);
  for (dem::TestRequest& test : planned.tests) set_test(test, densities, settings.shear_strain, path, frame);
  dem::TestRequest& rehearsal = planned.tests.emplace_back();
  rehearsal.name = kRehearsal;
  rehearsal.branch = path.branch;
  rehearsal.densities = {path.nu};
  rehearsal.segments = path.segments;
  rehearsal.role = Role::validation;
  Json document = Json(dem::spec_to_json(planned));
  std::vector<std::uint64_t> seeds = frame.seeds;
  seeds.resize(std::min(seeds.size(), static_cast<std::size_t>(settings.packings)));
  for (std::uint64_t next = *std::max_element(frame.seeds.begin(), frame.seeds.end()) + 1;
       seeds.size() < static_cast<std::size_t>(settings.packings); ++next)
    seeds.push_back(next);
  document["seeds"] = seeds;
  document["particles"] = settings.particles;
  document["strain_rate"] = settings.strain_rate;
  document["time_step_fraction"] = settings.time_step_fraction;
  document["densities"] = densities;
  return dem::spec_from_json(document, "the plan's SPEC");
}

dem::Spec rounds_of(dem::Spec planned) {
  std::erase_if(planned.tests,
                [](const dem::TestRequest& test) { return test.role != Role::calibration && test.name != kRehearsal; });
  return planned;
}

Work work_of(const dem::Spec& planned) {
  dem::Spec one = rounds_of(planned);
  one.seeds.resize(1);
  const dem::PreparationOptions& o = planned.preparation;
  const double N = static_cast<double>(o.packing.particles);
  Work work;
  work.preparation = N * dem::expected_steps(o);
  work.relaxed = N * static_cast<double>(o.keep_loading.size() + o.keep_unloading.size());
  for (const dem::PlannedTest& test : plan(one)) {
    if (test.role == Role::calibration) ++work.fitted_tests;
    if (!test.branch_of_preparation) work.tests += N * dem::expected_steps(o, resolve(test.path));
  }
  return work;
}

PlanSettings pilot_settings(const dem::Spec& frame, const std::string& name) {
  if (frame.preparation.drive.quasi_static_step > 0)
    throw InvalidInput(fmt::format(
        "{}: quasi_static_step: a plan chooses strain rate and time step, which minimised steps do not have; "
        "leave it 0",
        name));
  const double wanted = frame.preparation.drive.strain_rate, fast = rate_of(kPilotInertia, frame.preparation.packing);
  double rate = wanted;
  while (2 * rate <= fast) rate *= 2;
  return {kPilotParticles, kPilotPackings, rate, std::min(kLargestStep, frame.preparation.engine.time_step_fraction),
          kPilotDensities, kPilotStrain};
}

std::vector<double> plan_strains(const PlanSettings& pilot) { return {0.7 * pilot.shear_strain, pilot.shear_strain}; }

std::vector<PlanSettings> plan_grid(const PlanSettings& pilot, double wanted_rate) {
  std::vector<PlanSettings> grid;
  for (const std::int64_t larger : {1, 2, 4, 8, 16}) {
    for (double rate = wanted_rate; rate <= 2 * pilot.strain_rate; rate *= 2) {
      for (const double step : {1., 0.5}) {
        for (const int densities : {4, 6, 8}) {
          for (const double strain : plan_strains(pilot)) {
            PlanSettings s = pilot;
            s.particles *= larger;
            s.strain_rate = rate;
            s.time_step_fraction *= step;
            s.densities = densities;
            s.shear_strain = strain;
            grid.push_back(s);
          }
        }
      }
    }
  }
  return grid;
}

}  // namespace grainlaw::chain
