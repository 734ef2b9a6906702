#include "dem/element_tests/element_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "dem/engine/averages.hpp"
#include "dem/engine/energy_account.hpp"
#include "dem/element_tests/path_row.hpp"
#include "dem/element_tests/quasi_static.hpp"
#include "dem/engine/run_watch.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kMaxSteps = 1e12;            // per segment: years of work; beyond it a rate was mistyped
constexpr double kRounding = 1e-11;           // of the energies' sum: what is lost in adding it up over a run

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

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
  synchronise(sim);
  State state = std::move(sim.state);
  for (auto* a : {&state.ax, &state.ay, &state.az}) a->clear();
  return start_simulation(std::move(state), sim.options, motion);
}

/// How far the energies of a run are out of balance, row by row. Early in shear W_box is negative before it grows, and
/// a residual relative to the work *so far* would judge by a scale that passes zero. The judge's scale is therefore the
/// largest |W_box| of the rows so far, which equals the column energy_residual wherever the work is at its largest.
class BalanceJudge {
 public:
  /// |imbalance| over max |W_box| + E_kin(0) + D; 0 where adding up the energies can lose as much by rounding. To be
  /// asked for each row in turn; `first` is the first one.
  double residual(const Observation& row, const Observation& first) {
    largest_work_ = std::max(largest_work_, std::abs(row.W_box));
    const double exchanged = first.E_kin + row.D_contact + row.D_background;
    const double imbalance = std::abs(row.energy_residual) * (std::abs(row.W_box) + exchanged);
    if (imbalance <= kRounding * (row.E_pot + row.E_kin + first.E_pot + first.E_kin)) return 0;
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
  TestRun(const std::vector<StraightSegment>& segments, const ElementTestOptions& options, const RunControl& control,
          const StepObserver& on_step, const Checkpointing& checkpointing)
      : segments_(segments), options_(options), on_step_(on_step), checkpointing_(checkpointing),
        N_(shear_direction(segments)), watch_(control, "element test", "particle-steps") {}

  void start(const State& state) {
    CellMotion motion;
    motion.H = state.packing.H;
    motion.transport = options_.drive.transport;
    if (!segments_.empty()) motion = motion_at(make_drive(segments_[0], options_.drive, state.packing.H), 0);
    start_engine(fresh(state), motion);
    open_ledger(sim_);
    take_row(motion, segments_.empty() ? StraightSegment{} : segments_[0], 0);
  }

  void resume(Checkpoint from) {
    const auto refuse_if = [](bool wrong) {
      if (wrong) throw InvalidInput("the checkpoint is not one of this test; start it anew");
    };
    refuse_if(from.segment < 0 || static_cast<std::size_t>(from.segment) >= segments_.size() || from.rows.empty());
    at_ = std::move(from);
    CellMotion motion;
    motion.H = at_.state.packing.H;
    motion.transport = options_.drive.transport;
    refuse_if(at_.state.ax.empty() || at_.state.ref_x.empty());
    start_engine(std::move(at_.state), motion);
    refuse_if(at_.segment_steps < 1 || at_.segment_steps > steps_for(drive_of_segment()) || at_.steps < at_.segment_steps);
    for (int i = 0; i < at_.segment; ++i) sheared_ += shear_length(segments_[static_cast<std::size_t>(i)]);
    for (const Observation& row : at_.rows) judge(row);
  }

  ElementTest run() {
    for (; static_cast<std::size_t>(at_.segment) < segments_.size(); ++at_.segment, at_.segment_steps = 0) run_segment();
    ElementTest result;
    imbalance_.report(result.warnings, "energy residual", options_.warn_energy_residual, at_.rows.size());
    rate_.report(result.warnings, "inertial number", options_.warn_inertial_number, at_.rows.size());
    result.steps = at_.steps;
    result.time_step = at_.time_step;
    result.seconds = seconds();
    result.rows = std::move(at_.rows);
    synchronise(sim_);
    result.end = std::move(sim_.state);
    return result;
  }

 private:
  const StraightSegment& segment() const { return segments_[static_cast<std::size_t>(at_.segment)]; }
  Drive drive_of_segment() const { return make_drive(segment(), options_.drive, at_.segment_H); }
  double seconds() const { return at_.seconds + seconds_since(began_); }

  void start_engine(State state, const CellMotion& motion) {
    sim_ = start_simulation(std::move(state), options_.engine, motion);
    engine_dt_ = sim_.dt;
    for (const StraightSegment& segment : segments_) {
      total_steps_ += static_cast<double>(steps_for(make_drive(segment, options_.drive, motion.H)));
    }
  }

  void run_segment() {
    if (at_.segment_steps == 0) at_.segment_H = sim_.state.packing.H;
    const Drive drive = drive_of_segment();
    const std::uint64_t steps = steps_for(drive);
    const double dt = drive.duration / static_cast<double>(steps);
    if (at_.segment > 0 && at_.segment_steps == 0) sim_ = restarted(std::move(sim_), motion_at(drive, 0));
    sim_.dt = dt;
    at_.time_step = std::max(at_.time_step, dt);
    const auto time_of = [&](std::uint64_t k) { return k == steps ? drive.duration : static_cast<double>(k) * dt; };
    int next_row = 1;
    if (at_.segment_steps > 0) {
      const double e = path_parameter(drive, time_of(at_.segment_steps));
      next_row = row_after(1, e);
      after_step(e);
    }
    while (at_.segment_steps < steps) {
      const std::uint64_t k = at_.segment_steps;
      const CellMotion end = motion_at(drive, time_of(k + 1));
      advance(sim_, motion_at(drive, (static_cast<double>(k) + 0.5) * dt), end);
      ++at_.segment_steps;
      ++at_.steps;
      const double e = path_parameter(drive, time_of(k + 1));
      if (row_after(next_row, e) != next_row) {
        take_row(end, segment(), e);
        next_row = row_after(next_row, e);
      }
      after_step(e);
    }
    sheared_ += shear_length(segment());
  }

  /// What is not the run itself: the observer, progress, and saving.
  void after_step(double e) {
    try {
      if (on_step_) on_step_(sim_, at_.segment, e);
      const double done = static_cast<double>(at_.steps);
      watch_.tick(done / total_steps_, done * static_cast<double>(sim_.state.packing.size()));
    } catch (const Interrupted&) {
      save();
      throw;
    }
    if (checkpointing_.save && seconds_since(saved_) >= checkpointing_.interval) save();
  }

  void save() {
    if (!checkpointing_.save) return;
    synchronise(sim_);
    Checkpoint checkpoint = at_;
    checkpoint.state = sim_.state;
    checkpoint.seconds = seconds();
    checkpointing_.save(checkpoint);
    saved_ = Clock::now();
  }

  double row_position(int row) const {
    const double length = segment().length;
    return row == options_.rows ? length : length * row / options_.rows;
  }

  /// The first row from `next` on whose place is beyond e.
  int row_after(int next, double e) const {
    while (next <= options_.rows && e >= row_position(next)) ++next;
    return next;
  }

  std::uint64_t steps_for(const Drive& drive) const {
    const double steps = std::ceil(drive.duration / engine_dt_ * (1 - 1e-12));
    if (!(steps <= kMaxSteps)) {
      throw InvalidInput(fmt::format("strain_rate: at {} 1/s a segment would take {:.3g} steps; give a larger one",
                                     options_.drive.strain_rate, steps));
    }
    return static_cast<std::uint64_t>(std::max(1.0, steps));
  }

  /// Notes what is beyond its limit; the residual is returned.
  double judge(const Observation& row) {
    const double residual = judge_.residual(row, at_.rows.front());
    imbalance_.note(residual, options_.warn_energy_residual, row.nu);
    rate_.note(row.inertial_number, options_.warn_inertial_number, row.nu);
    return residual;
  }

  void take_row(const CellMotion& motion, const StraightSegment& on, double e) {
    synchronise(sim_);
    at_.rows.push_back(observe(sim_, motion, N_));
    Observation& row = at_.rows.back();
    fill_path(row, on, at_.segment, e, sheared_);
    const double residual = judge(row);
    if (!(residual <= options_.stop_energy_residual)) {
      throw Error(fmt::format(
          "energy balance: residual {:.3g} at row {} (segment {}, nu = {:.6g}, step {}) is beyond {}; the results would be "
          "wrong, give a smaller time_step_fraction than {}",
          residual, at_.rows.size() - 1, at_.segment, row.nu, sim_.state.step, options_.stop_energy_residual,
          options_.engine.time_step_fraction));
    }
  }

  const std::vector<StraightSegment>& segments_;
  const ElementTestOptions& options_;
  const StepObserver& on_step_;
  const Checkpointing& checkpointing_;
  Deviator<double> N_;
  RunWatch watch_;
  Checkpoint at_;           // where the run stands; its state is sim_'s
  Simulation sim_;
  double engine_dt_ = 0;    // [s]
  double total_steps_ = 0;  // of all segments
  BalanceJudge judge_;
  Excess imbalance_, rate_;
  double sheared_ = 0;      // shear path of the segments that are done
  Clock::time_point began_ = Clock::now(), saved_ = began_;
};

}  // namespace

ElementTest run_element_test(const State& start, const std::vector<StraightSegment>& segments,
                             const ElementTestOptions& options, const RunControl& control, const StepObserver& on_step,
                             const Checkpointing& checkpointing) {
  check_options(start, options);
  if (options.drive.quasi_static_step > 0)
    return run_quasi_static_test(start, segments, options, control, on_step, checkpointing);
  TestRun run(segments, options, control, on_step, checkpointing);
  run.start(start);
  return run.run();
}

ElementTest continue_element_test(Checkpoint from, const std::vector<StraightSegment>& segments,
                                  const ElementTestOptions& options, const RunControl& control,
                                  const StepObserver& on_step, const Checkpointing& checkpointing) {
  check_options(from.state, options);
  if (options.drive.quasi_static_step > 0)
    return continue_quasi_static_test(std::move(from), segments, options, control, on_step, checkpointing);
  TestRun run(segments, options, control, on_step, checkpointing);
  run.resume(std::move(from));
  return run.run();
}

double largest_energy_residual(const std::vector<Observation>& rows) {
  BalanceJudge judge;
  double largest = 0;
  for (const Observation& row : rows) largest = std::max(largest, judge.residual(row, rows.front()));
  return largest;
}

}  // namespace grainlaw::dem
