#include "dem/element_tests/preparation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include "dem/element_tests/stepper.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

double nu_end(const PreparationOptions& o) {
  if (o.nu_end) return *o.nu_end;
  return o.keep_unloading.empty() ? o.nu_start : *std::min_element(o.keep_unloading.begin(), o.keep_unloading.end());
}

/// Densities of a branch in the order in which it crosses them, each once.
std::vector<double> crossing_order(std::vector<double> densities, Branch branch) {
  std::sort(densities.begin(), densities.end());
  densities.erase(std::unique(densities.begin(), densities.end()), densities.end());
  if (branch == Branch::unloading) std::reverse(densities.begin(), densities.end());
  return densities;
}

ElementTestOptions gas_options(const PreparationOptions& options) {
  ElementTestOptions gas = test_options(options);
  gas.drive.strain_rate *= options.gas_compression_factor;
  gas.drive.quasi_static_step = 0;                                     // a gas has no equilibrium
  gas.warn_inertial_number = std::numeric_limits<double>::infinity();  // a gas is not meant to be quasi-static
  return gas;
}

constexpr const char* kGasCompression = "gas compression";

/// Where a stage begins: at a state, or on its way.
using Origin = std::variant<State, Checkpoint>;

class Preparation {
 public:
  Preparation(const PreparationOptions& options, const PreparationSink& sink, const RunControl& control,
              const Checkpointing& checkpointing)
      : options_(options), sink_(sink), control_(control), checkpointing_(checkpointing) {}

  void run(std::optional<Checkpoint> from) {
    if (from && from->stage == to_string(Branch::unloading)) {
      unload(std::move(*from));
    } else if (from && from->stage == to_string(Branch::loading)) {
      unload(load(std::move(*from)));
    } else if (from && from->stage != kGasCompression) {
      throw InvalidInput(fmt::format("checkpoint: '{}' is no stage of a preparation; start it anew", from->stage));
    } else {
      unload(load(from ? compress(std::move(*from)) : compress(gas())));
    }
  }

 private:
  State gas() const {
    return random_gas(options_.packing, options_.nu_gas, options_.engine, with_stage(control_, "random gas"));
  }

  State compress(Origin from) {
    State start = drive_to(std::move(from), options_.nu_start, gas_options(options_), kGasCompression, {}).end;
    scale_to_volume_fraction(start.packing, options_.nu_start, options_.engine.portable_bits);
    relax(start, options_.engine, options_.relax, with_stage(control_, "relaxation of the gas"));
    return start;
  }

  State load(Origin from) {
    return run_branch(Branch::loading, std::move(from), options_.nu_max, options_.keep_loading);
  }

  void unload(Origin from) {
    run_branch(Branch::unloading, std::move(from), nu_end(options_), options_.keep_unloading);
  }

  /// One isotropic run to `to_nu`; warnings go to the sink.
  ElementTest drive_to(Origin from, double to_nu, const ElementTestOptions& options, const std::string& stage,
                       const StepObserver& on_step) {
    Checkpoint* checkpoint = std::get_if<Checkpoint>(&from);
    if (checkpoint) steps_before_ = checkpoint->steps_before;
    const Checkpointing staged = with_stage(checkpointing_, stage, steps_before_, seconds_before_);
    const RunControl control = with_stage(
        control_, stage, static_cast<double>(steps_before_) * static_cast<double>(options_.packing.particles));
    const auto segment = isotropic_segment(volume_fraction(start_of(from)), to_nu, options_.engine.portable_bits);
    ElementTest test = checkpoint
                           ? continue_element_test(std::move(*checkpoint), segment, options, control, on_step, staged)
                           : run_element_test(std::get<State>(from), segment, options, control, on_step, staged);
    steps_before_ += test.steps;
    seconds_before_ += test.seconds;
    if (sink_.warn) {
      for (const std::string& warning : test.warnings) sink_.warn(stage + ": " + warning);
    }
    return test;
  }

  /// Packing in the cell in which the stage began.
  static Packing start_of(const Origin& from) {
    if (const State* state = std::get_if<State>(&from)) return state->packing;
    const Checkpoint& checkpoint = std::get<Checkpoint>(from);
    Packing packing = checkpoint.state.packing;
    packing.H = checkpoint.segment_H;
    return packing;
  }

  /// A branch with its kept states; returns the state at its end.
  State run_branch(Branch branch, Origin from, double to_nu, const std::vector<double>& keep) {
    const std::vector<double> densities = crossing_order(keep, branch);
    const double nu_0 = volume_fraction(start_of(from));
    std::size_t next = 0;
    const auto keep_state = [&](const State& passing) {
      const double nu = densities[next];
      if (!(sink_.has && sink_.has(branch, nu))) {
        KeptState kept{branch, nu, passing, {}};
        scale_to_volume_fraction(kept.state.packing, nu, options_.engine.portable_bits);
        const RunControl named = with_stage(control_, fmt::format("relaxation at {:.4g}", nu));
        kept.relaxation = relax(kept.state, options_.engine, options_.relax, named);
        sink_.keep(kept);
      }
      ++next;
    };
    const auto on_step = [&](Stepper& stepper, int, double e) {
      // e of an isotropic segment is |ln(nu/nu_0)|/3; rounding must not lose a density at its end
      while (next < densities.size() && e >= std::abs(std::log(densities[next] / nu_0)) / 3 - 1e-13) {
        keep_state(stepper.simulation().state());
      }
    };
    ElementTest test = drive_to(std::move(from), to_nu, test_options(options_), to_string(branch), on_step);
    sink_.series(branch, test.rows);
    return std::move(test.end);
  }

  const PreparationOptions& options_;
  const PreparationSink& sink_;
  const RunControl& control_;
  const Checkpointing& checkpointing_;
  std::uint64_t steps_before_ = 0;  // of the stages that are over
  double seconds_before_ = 0;       // likewise
};

void check_sink(const PreparationSink& sink) {
  if (!sink.keep || !sink.series) throw Error("preparation: its sink needs keep and series");
}

}  // namespace

ElementTestOptions test_options(const PreparationOptions& options) {
  return {options.engine, options.drive, options.relax, options.rows};
}

std::vector<StraightSegment> isotropic_segment(double from_nu, double to_nu, bool portable) {
  const StrainRate direction = direction_of(Mode::ISO, "xyz", to_nu < from_nu);
  return resolve({from_nu, Branch::loading, {{Mode::ISO, direction, ExtentKind::target_nu, to_nu}}}, portable);
}

RunControl with_stage(const RunControl& control, const std::string& stage, double work_before) {
  RunControl named = control;
  if (control.report) {
    named.report = [&control, stage, work_before](Progress progress) {
      progress.stage = stage;
      progress.work += work_before;
      control.report(progress);
    };
  }
  return named;
}

Checkpointing with_stage(const Checkpointing& checkpointing, const std::string& stage, std::uint64_t steps_before,
                         double seconds_before) {
  Checkpointing named = checkpointing;
  if (checkpointing.save) {
    named.save = [&checkpointing, stage, steps_before, seconds_before](Checkpoint at) {
      at.stage = stage;
      at.steps_before = steps_before;
      at.seconds += seconds_before;
      checkpointing.save(at);
    };
  }
  return named;
}

void check(const PreparationOptions& o) {
  check(o.choice, o.engine, o.drive);
  const auto refuse = [](const std::string& why) { throw InvalidInput(why); };
  if (o.nu_start >= o.nu_max) refuse(fmt::format("nu_max: {} must lie above nu_start = {}", o.nu_max, o.nu_start));
  if (!(o.nu_gas < o.nu_start && o.nu_start < o.nu_max && o.nu_max <= kMaxVolumeFraction)) {
    refuse(fmt::format("nu_gas, nu_start, nu_max: {}, {}, {} must increase and end at {} or below", o.nu_gas,
                       o.nu_start, o.nu_max, kMaxVolumeFraction));
  }
  const double lowest = o.nu_end.value_or(o.nu_start);
  if (!(lowest >= o.nu_start && lowest < o.nu_max)) {
    refuse(fmt::format("nu_end: {} must lie within [nu_start, nu_max) = [{}, {})", lowest, o.nu_start, o.nu_max));
  }
  for (const double nu : o.keep_loading) {
    if (!(nu >= o.nu_start && nu <= o.nu_max)) {
      refuse(fmt::format("densities: {} is not on the loading branch [nu_start, nu_max] = [{}, {}]", nu, o.nu_start,
                         o.nu_max));
    }
  }
  for (const double nu : o.keep_unloading) {
    if (!(nu >= lowest && nu <= o.nu_max)) {
      refuse(fmt::format("densities or keep: {} is not on the unloading branch [nu_end, nu_max] = [{}, {}]", nu, lowest,
                         o.nu_max));
    }
  }
  if (!(o.gas_compression_factor > 0) || !std::isfinite(o.gas_compression_factor)) {
    refuse("gas_compression_factor: must be positive and finite");
  }
}

void prepare(const PreparationOptions& options, const PreparationSink& sink, const RunControl& control,
             const Checkpointing& checkpointing) {
  check_sink(sink);
  check(options);
  Preparation(options, sink, control, checkpointing).run({});
}

void continue_preparation(Checkpoint from, const PreparationOptions& options, const PreparationSink& sink,
                          const RunControl& control, const Checkpointing& checkpointing) {
  check_sink(sink);
  check(options);
  Preparation(options, sink, control, checkpointing).run(std::move(from));
}

}  // namespace grainlaw::dem
