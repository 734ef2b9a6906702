#include "dem/element_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "dem/averages.hpp"
#include "dem/run_watch.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kMaxSteps = 1e12;            // per segment: years of work; beyond it a rate was mistyped
constexpr double kRounding = 1e-11;           // of the energies' sum: what is lost in adding it up over a run

void check_options(const State& start, const ElementTestOptions& options) {
  const double fraction = options.engine.time_step_fraction;
  if (!(fraction > 0) || !std::isfinite(fraction)) {
    throw InvalidInput(fmt::format("time_step_fraction: {} must be positive and finite", fraction));
  }
  if (options.check_time_step && fraction > kMaxTimeStepFraction) {
    throw InvalidInput(fmt::format(
        "time_step_fraction: {} is beyond {}, where the integration becomes unstable; give a smaller one", fraction,
        kMaxTimeStepFraction));
  }
  if (options.rows < 1) throw InvalidInput("rows: must be at least 1");
  if (start.packing.size() == 0) throw InvalidInput("packing: an element test needs at least one sphere");
}

/// The state as a new run sees it: clock and accelerations forgotten, the ledger is opened later.
State fresh(State state) {
  state.step = 0;
  state.time = 0;
  for (auto* a : {&state.ax, &state.ay, &state.az, &state.ref_x, &state.ref_y, &state.ref_z}) a->clear();
  return state;
}

/// Forces for a velocity gradient that has jumped.
Simulation restarted(Simulation sim, const CellMotion& motion) {
  State state = std::move(sim.state);
  for (auto* a : {&state.ax, &state.ay, &state.az}) a->clear();
  return start_simulation(std::move(state), sim.options, motion);
}

double shear_length(const StraightSegment& segment) { return segment.eps_dev_rate() * segment.length; }

/// What an observation takes from the path instead of the packing.
void fill_path(Observation& row, const StraightSegment& segment, int index, double e, double sheared_before) {
  row.segment = index;
  row.strain = segment.strain(e);
  row.eps_vol = row.strain.tensor.trace();
  row.eps_dev = deviatoric_norm(row.strain.tensor);
  row.shear_path = sheared_before + segment.eps_dev_rate() * e;
  // after a reversal to the start only rounding is left: it has no direction
  if (row.eps_dev > 1e-12 * (row.shear_path + std::abs(row.eps_vol))) {
    row.shape_strain = shape_factor(row.strain.tensor);
    row.lode_strain = lode_angle(row.strain.tensor);
  }
}

/// How far the energies of a run are out of balance, row by row. Early in shear W_box is negative before it grows, and
/// a residual relative to the work *so far* would judge by a scale that passes zero. The judge's scale is therefore the
/// largest |W_box| of the rows so far, which equals the column energy_residual wherever the work is at its largest.
class BalanceJudge {
 public:
  /// |imbalance| over max |W_box| + E_kin(0) + D; 0 where adding up the energies can lose as much by rounding.
  double residual(const Observation& row, const Ledger& ledger) {
    largest_work_ = std::max(largest_work_, std::abs(ledger.W_box));
    const double exchanged = ledger.E_kin_start + ledger.D_contact + ledger.D_background;
    const double imbalance = std::abs(row.energy_residual) * (std::abs(ledger.W_box) + exchanged);
    if (imbalance <= kRounding * (row.E_pot + row.E_kin + std::abs(ledger.E_start))) return 0;
    return imbalance / (largest_work_ + exchanged);
  }

 private:
  double largest_work_ = 0;  // [J]
};

/// Rows on which a quantity was beyond its limit.
struct Excess {
  std::size_t rows = 0;
  double worst = 0, nu = 0;  // the largest value and where it was

  void note(double value, double limit, double at_nu) {
    if (!(value > limit)) return;
    ++rows;
    if (value > worst) worst = value, nu = at_nu;
  }
  void report(std::vector<std::string>& warnings, const char* what, double limit, std::size_t of) const {
    if (rows == 0) return;
    warnings.push_back(fmt::format("{} above {} in {} of {} rows, up to {:.3g} at nu = {:.4f}", what, limit, rows, of, worst, nu));
  }
};

/// One run in progress: simulation, path and what has been seen so far.
class TestRun {
 public:
  TestRun(const State& start, const std::vector<StraightSegment>& segments, const ElementTestOptions& options,
          const RunControl& control, const StepObserver& on_step)
      : segments_(segments), options_(options), on_step_(on_step), N_(shear_direction(segments)),
        watch_(control, "element test", "particle-steps") {
    CellMotion motion;
    motion.H = start.packing.H;
    motion.transport = options.drive.transport;
    if (!segments.empty()) motion = motion_at(make_drive(segments[0], options.drive, start.packing.H), 0);
    sim_ = start_simulation(fresh(start), options.engine, motion);
    open_ledger(sim_);
    engine_dt_ = sim_.dt;
    for (const StraightSegment& segment : segments) {
      total_steps_ += static_cast<double>(steps_for(make_drive(segment, options.drive, start.packing.H)));
    }
    if (segments.empty()) {
      StraightSegment rest;
      take_row(motion, rest, 0, 0);
    } else {
      take_row(motion, segments[0], 0, 0);
    }
  }

  void run_segment(int index) {
    const StraightSegment& segment = segments_[static_cast<std::size_t>(index)];
    const Drive drive = make_drive(segment, options_.drive, sim_.state.packing.H);
    const std::uint64_t steps = steps_for(drive);
    const double dt = drive.duration / static_cast<double>(steps);
    if (index > 0) sim_ = restarted(std::move(sim_), motion_at(drive, 0));
    sim_.dt = dt;
    result_.time_step = std::max(result_.time_step, dt);
    const double length = segment.length;
    int next = 1;  // row to be taken next
    for (std::uint64_t k = 0; k < steps; ++k) {
      const double t = k + 1 == steps ? drive.duration : static_cast<double>(k + 1) * dt;
      const CellMotion end = motion_at(drive, t);
      advance(sim_, motion_at(drive, (static_cast<double>(k) + 0.5) * dt), end);
      const double e = path_parameter(drive, t);
      if (next <= options_.rows && e >= row_position(next, length)) {
        take_row(end, segment, index, e);
        while (next <= options_.rows && e >= row_position(next, length)) ++next;
      }
      if (on_step_) on_step_(sim_, index, e);
      ++result_.steps;
      const double done = static_cast<double>(result_.steps);
      watch_.tick(done / total_steps_, done * static_cast<double>(sim_.state.packing.size()));
    }
    sheared_ += shear_length(segment);
  }

  ElementTest finish() {
    imbalance_.report(result_.warnings, "energy residual", options_.warn_energy_residual, result_.rows.size());
    rate_.report(result_.warnings, "inertial number", options_.warn_inertial_number, result_.rows.size());
    result_.end = std::move(sim_.state);
    return std::move(result_);
  }

 private:
  double row_position(int row, double length) const {
    return row == options_.rows ? length : length * row / options_.rows;
  }

  std::uint64_t steps_for(const Drive& drive) const {
    const double steps = std::ceil(drive.duration / engine_dt_ * (1 - 1e-12));
    if (!(steps <= kMaxSteps)) {
      throw InvalidInput(fmt::format("strain_rate: at {} 1/s a segment would take {:.3g} steps; give a larger one",
                                     options_.drive.strain_rate, steps));
    }
    return static_cast<std::uint64_t>(std::max(1.0, steps));
  }

  void take_row(const CellMotion& motion, const StraightSegment& segment, int index, double e) {
    Observation row = observe(sim_, motion, N_);
    fill_path(row, segment, index, e, sheared_);
    result_.rows.push_back(row);
    const double residual = judge_.residual(row, sim_.state.ledger);
    imbalance_.note(residual, options_.warn_energy_residual, row.nu);
    rate_.note(row.inertial_number, options_.warn_inertial_number, row.nu);
    if (!(residual <= options_.stop_energy_residual)) {
      throw Error(fmt::format(
          "energy balance: residual {:.3g} at row {} (segment {}, nu = {:.6g}, step {}) is beyond {}; the results would be "
          "wrong, give a smaller time_step_fraction than {}",
          residual, result_.rows.size() - 1, index, row.nu, sim_.state.step, options_.stop_energy_residual,
          options_.engine.time_step_fraction));
    }
  }

  const std::vector<StraightSegment>& segments_;
  const ElementTestOptions& options_;
  const StepObserver& on_step_;
  Deviator<double> N_;
  RunWatch watch_;
  Simulation sim_;
  double engine_dt_ = 0;    // [s]
  double total_steps_ = 0;  // of all segments
  BalanceJudge judge_;
  Excess imbalance_, rate_;
  double sheared_ = 0;      // shear path of the segments that are done
  ElementTest result_;
};

}  // namespace

ElementTest run_element_test(const State& start, const std::vector<StraightSegment>& segments,
                             const ElementTestOptions& options, const RunControl& control, const StepObserver& on_step) {
  check_options(start, options);
  const auto began = std::chrono::steady_clock::now();
  TestRun run(start, segments, options, control, on_step);
  for (std::size_t i = 0; i < segments.size(); ++i) run.run_segment(static_cast<int>(i));
  ElementTest test = run.finish();
  test.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return test;
}

}  // namespace grainlaw::dem
