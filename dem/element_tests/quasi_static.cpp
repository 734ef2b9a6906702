#include "dem/element_tests/quasi_static.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "dem/engine/averages.hpp"
#include "dem/element_tests/path_row.hpp"
#include "dem/engine/run_watch.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kMaxSteps = 1e9;  // per segment: years of work; beyond it a step was mistyped

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

CellMotion at_rest(const Packing& packing) {
  CellMotion motion;
  motion.H = packing.H;
  return motion;
}

/// One run in progress: at_.state is in equilibrium, at_.segment_steps counts affine steps, at_.steps force passes.
class QuasiStaticRun {
 public:
  QuasiStaticRun(const std::vector<StraightSegment>& segments, const ElementTestOptions& options,
                 const RunControl& control, const StepObserver& on_step, const Checkpointing& checkpointing)
      : segments_(segments),
        options_(options),
        on_step_(on_step),
        checkpointing_(checkpointing),
        N_(shear_direction(segments)),
        watch_(control, "quasi-static test", "particle-steps") {
    if (options.drive.transport == Transport::wall)
      throw InvalidInput("quasi_static_step: spheres move with the cell; leave transport homogeneous");
    minimising_.stop = control.stop;  // the run itself reports
    contacts_ = options.engine;
    contacts_.precision = Precision::reference;
    for (const StraightSegment& segment : segments) whole_strain_ += strain_of(segment);
  }

  void start(const State& state) {
    at_.state = state;
    at_.state.ledger.E_start = settle(at_.state).E_after;
    Simulation sim = simulation();
    take_row(sim, segments_.empty() ? StraightSegment{} : segments_[0], 0);
  }

  void resume(Checkpoint from) {
    if (from.segment < 0 || static_cast<std::size_t>(from.segment) >= segments_.size() || from.rows.empty() ||
        from.segment_steps < 1 || from.segment_steps > steps_of(segments_[static_cast<std::size_t>(from.segment)])) {
      throw InvalidInput("the checkpoint is not one of this test; start it anew");
    }
    at_ = std::move(from);
    for (int i = 0; i < at_.segment; ++i) leave(segments_[static_cast<std::size_t>(i)]);
    if (!on_step_) return;
    Simulation sim = simulation();
    on_step_(sim, at_.segment, place(at_.segment_steps));
  }

  ElementTest run() {
    for (; static_cast<std::size_t>(at_.segment) < segments_.size(); ++at_.segment, at_.segment_steps = 0) {
      if (at_.segment_steps == 0) at_.segment_H = at_.state.packing.H;
      while (at_.segment_steps < steps_of(segment())) {
        try {
          step();
        } catch (const Interrupted&) {
          if (at_.segment_steps > 0) save();
          throw;
        }
        if (checkpointing_.save && seconds_since(saved_) >= checkpointing_.interval) save();
      }
      leave(segment());
    }
    ElementTest result;
    if (unsettled_ > 0) {
      result.warnings.push_back(fmt::format("{} minimisations stopped short of equilibrium after {} force passes",
                                            unsettled_, options_.relax.max_passes));
    }
    result.steps = at_.steps;
    result.seconds = seconds();
    result.rows = std::move(at_.rows);
    result.end = std::move(at_.state);
    return result;
  }

 private:
  const StraightSegment& segment() const { return segments_[static_cast<std::size_t>(at_.segment)]; }
  double seconds() const { return at_.seconds + seconds_since(began_); }

  std::uint64_t steps_of(const StraightSegment& on) const {
    return quasi_static_steps(on, options_.drive, options_.rows);
  }

  /// e after so many steps of the segment.
  double place(std::uint64_t step) const {
    const std::uint64_t steps = steps_of(segment());
    return step == steps ? segment().length : segment().length * static_cast<double>(step) / static_cast<double>(steps);
  }

  /// max(|eps_vol|, eps_dev) summed along the path up to e of the segment.
  double strained(double e) const { return strain_before_ + strain_of(segment()) * e / segment().length; }

  void leave(const StraightSegment& on) {
    strain_before_ += strain_of(on);
    sheared_before_ += shear_length(on);
  }

  Relaxation settle(State& state) {
    const Relaxation settled = relax(state, options_.engine, options_.relax, minimising_);
    at_.steps += static_cast<std::uint64_t>(settled.passes);
    if (!settled.relaxed) ++unsettled_;
    return settled;
  }

  void step() {
    const double e = place(at_.segment_steps + 1);
    deform(e);
    ++at_.segment_steps;
    const bool ends_row = at_.segment_steps % (steps_of(segment()) / static_cast<std::uint64_t>(options_.rows)) == 0;
    if (ends_row || on_step_) {
      Simulation sim = simulation();
      if (ends_row) take_row(sim, segment(), e);
      if (on_step_) on_step_(sim, at_.segment, e);
    }
    watch_.tick(strained(e) / whole_strain_,
                static_cast<double>(at_.steps) * static_cast<double>(at_.state.packing.size()));
  }

  /// The cell and the spheres in it to e, then equilibrium. Nothing has changed where that is interrupted.
  void deform(double e) {
    State next = at_.state;
    const Eigen::Vector3d stretch = (e * segment().direction.tensor.diagonal()).array().exp();
    next.packing.H = stretch.asDiagonal() * at_.segment_H;
    Ledger ledger = at_.state.ledger;
    const double E_pot = ledger.E_start + ledger.W_box - ledger.D_contact;
    const Relaxation settled = settle(next);
    ledger.W_box += settled.E_before - E_pot;
    ledger.D_contact += settled.E_before - settled.E_after;
    next.ledger = ledger;
    next.step = at_.steps;
    next.time = strained(e) / options_.drive.strain_rate;
    at_.state = std::move(next);
  }

  /// The state with its contacts.
  Simulation simulation() const { return start_simulation(at_.state, contacts_, at_rest(at_.state.packing)); }

  void take_row(const Simulation& sim, const StraightSegment& on, double e) {
    at_.rows.push_back(observe(sim, at_rest(at_.state.packing), N_));
    fill_path(at_.rows.back(), on, at_.segment, e, sheared_before_);
  }

  void save() {
    if (!checkpointing_.save) return;
    Checkpoint checkpoint = at_;
    checkpoint.seconds = seconds();
    checkpointing_.save(checkpoint);
    saved_ = Clock::now();
  }

  const std::vector<StraightSegment>& segments_;
  const ElementTestOptions& options_;
  const StepObserver& on_step_;
  const Checkpointing& checkpointing_;
  Deviator<double> N_;
  RunWatch watch_;
  RunControl minimising_;
  EngineOptions contacts_;  // for sums over contacts, in double
  Checkpoint at_;
  double whole_strain_ = 0, strain_before_ = 0, sheared_before_ = 0;
  std::size_t unsettled_ = 0;  // minimisations
  Clock::time_point began_ = Clock::now(), saved_ = began_;
};

}  // namespace

std::uint64_t quasi_static_steps(const StraightSegment& segment, const DriveOptions& drive, int rows) {
  const double per_row = std::ceil(strain_of(segment) / rows / drive.quasi_static_step * (1 - 1e-12));
  if (!(per_row * rows <= kMaxSteps)) {
    throw InvalidInput(
        fmt::format("quasi_static_step: at {} a segment would take {:.3g} minimisations; give a larger one",
                    drive.quasi_static_step, per_row * rows));
  }
  return static_cast<std::uint64_t>(std::max(1.0, per_row)) * static_cast<std::uint64_t>(rows);
}

ElementTest run_quasi_static_test(const State& start, const std::vector<StraightSegment>& segments,
                                  const ElementTestOptions& options, const RunControl& control,
                                  const StepObserver& on_step, const Checkpointing& checkpointing) {
  QuasiStaticRun run(segments, options, control, on_step, checkpointing);
  run.start(start);
  return run.run();
}

ElementTest continue_quasi_static_test(Checkpoint from, const std::vector<StraightSegment>& segments,
                                       const ElementTestOptions& options, const RunControl& control,
                                       const StepObserver& on_step, const Checkpointing& checkpointing) {
  QuasiStaticRun run(segments, options, control, on_step, checkpointing);
  run.resume(std::move(from));
  return run.run();
}

}  // namespace grainlaw::dem
