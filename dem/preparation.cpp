#include "dem/preparation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "model/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kMaxVolumeFraction = 0.9;

double nu_end(const PreparationOptions& o) {
  if (o.nu_end) return *o.nu_end;
  return o.keep_unloading.empty() ? o.nu_start : *std::min_element(o.keep_unloading.begin(), o.keep_unloading.end());
}

void check_options(const PreparationOptions& o, const PreparationSink& sink) {
  const auto refuse = [](const std::string& why) { throw InvalidInput(why); };
  if (!sink.keep || !sink.series) throw Error("preparation: its sink needs keep and series");
  if (!(o.nu_gas < o.nu_start && o.nu_start < o.nu_max && o.nu_max <= kMaxVolumeFraction)) {
    refuse(fmt::format("nu_gas, nu_start, nu_max: {}, {}, {} must increase and end at {} or below", o.nu_gas, o.nu_start,
                       o.nu_max, kMaxVolumeFraction));
  }
  for (const double nu : o.keep_loading) {
    if (!(nu > o.nu_start && nu <= o.nu_max)) {
      refuse(fmt::format("densities: {} of the loading branch is outside ({}, {}]", nu, o.nu_start, o.nu_max));
    }
  }
  const double lowest = o.nu_end.value_or(o.nu_start);
  if (!(lowest >= o.nu_start && lowest < o.nu_max)) {
    refuse(fmt::format("nu_end: {} is outside [nu_start, nu_max) = [{}, {})", lowest, o.nu_start, o.nu_max));
  }
  for (const double nu : o.keep_unloading) {
    if (!(nu >= lowest && nu < o.nu_max)) {
      refuse(fmt::format("densities: {} of the unloading branch is outside [{}, {})", nu, lowest, o.nu_max));
    }
  }
  if (!(o.gas_compression_factor > 0) || !std::isfinite(o.gas_compression_factor)) {
    refuse("gas_compression_factor: must be positive and finite");
  }
}

RunControl with_stage(const RunControl& control, const std::string& stage) {
  RunControl named = control;
  if (control.report) {
    named.report = [&control, stage](Progress progress) {
      progress.stage = stage;
      control.report(progress);
    };
  }
  return named;
}

std::vector<StraightSegment> isotropic_segment(const State& from, double to_nu) {
  const double nu = volume_fraction(from.packing);
  const StrainRate direction = direction_of(Mode::ISO, "xyz", to_nu < nu);
  return resolve({nu, Branch::loading, {{Mode::ISO, direction, ExtentKind::target_nu, to_nu}}});
}

/// Densities of a branch in the order in which it crosses them, each once.
std::vector<double> crossing_order(std::vector<double> densities, Branch branch) {
  std::sort(densities.begin(), densities.end());
  densities.erase(std::unique(densities.begin(), densities.end()), densities.end());
  if (branch == Branch::unloading) std::reverse(densities.begin(), densities.end());
  return densities;
}

ElementTestOptions branch_options(const PreparationOptions& options) {
  ElementTestOptions branch;
  branch.engine = options.engine;
  branch.drive = options.drive;
  branch.rows = options.rows;
  return branch;
}

ElementTestOptions gas_options(const PreparationOptions& options) {
  ElementTestOptions gas = branch_options(options);
  gas.drive.strain_rate *= options.gas_compression_factor;
  gas.warn_inertial_number = std::numeric_limits<double>::infinity();  // a gas is not meant to be quasi-static
  return gas;
}

/// One isotropic run to `to_nu`; warnings go to the sink.
ElementTest drive_to(const State& from, double to_nu, const ElementTestOptions& options, const std::string& stage,
                     const PreparationSink& sink, const RunControl& control, const StepObserver& on_step) {
  ElementTest test = run_element_test(from, isotropic_segment(from, to_nu), options, with_stage(control, stage), on_step);
  if (sink.warn) {
    for (const std::string& warning : test.warnings) sink.warn(stage + ": " + warning);
  }
  return test;
}

/// A branch with its kept states; returns the state at its end.
State run_branch(Branch branch, const State& from, double to_nu, const std::vector<double>& keep,
                 const PreparationOptions& options, const PreparationSink& sink, const RunControl& control) {
  const std::vector<double> densities = crossing_order(keep, branch);
  const double nu_0 = volume_fraction(from.packing);
  std::size_t next = 0;
  const auto keep_state = [&](const State& passing) {
    KeptState kept{branch, densities[next++], passing, {}};
    scale_to_volume_fraction(kept.state.packing, kept.nu);
    const RunControl named = with_stage(control, fmt::format("relaxation at {:.4g}", kept.nu));
    kept.relaxation = relax(kept.state, options.engine, options.relax, named);
    sink.keep(kept);
  };
  const auto on_step = [&](const Simulation& sim, int, double e) {
    // e of an isotropic segment is |ln(nu/nu_0)|/3; rounding must not lose a density at its end
    while (next < densities.size() && e >= std::abs(std::log(densities[next] / nu_0)) / 3 - 1e-13) keep_state(sim.state);
  };
  ElementTest test = drive_to(from, to_nu, branch_options(options), to_string(branch), sink, control, on_step);
  sink.series(branch, test.rows);
  return std::move(test.end);
}

}  // namespace

void prepare(const PreparationOptions& options, const PreparationSink& sink, const RunControl& control) {
  check_options(options, sink);
  const State gas = random_gas(options.packing, options.nu_gas, options.engine, with_stage(control, "random gas"));
  State start = drive_to(gas, options.nu_start, gas_options(options), "gas compression", sink, control, {}).end;
  scale_to_volume_fraction(start.packing, options.nu_start);
  relax(start, options.engine, options.relax, with_stage(control, "relaxation of the gas"));
  const State dense =
      run_branch(Branch::loading, start, options.nu_max, options.keep_loading, options, sink, control);
  run_branch(Branch::unloading, dense, nu_end(options), options.keep_unloading, options, sink, control);
}

}  // namespace grainlaw::dem
