#include "dem/element_tests/element_run.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "dem/element_tests/stepper.hpp"
#include "dem/engine/averages.hpp"
#include "dem/engine/run_watch.hpp"

namespace grainlaw::dem {
namespace {

void check_options(const State& start, const ElementTestOptions& options) {
  if (options.rows < 1) throw InvalidInput("rows: must be at least 1");
  if (start.packing.size() == 0) throw InvalidInput("packing: an element test needs at least one sphere");
  if (options.check_time_step)
    check_time_step(options.engine.time_step_fraction, start.material, lightest_pair(start.packing));
}

/// One run in progress: where it stands on the path and what has been seen so far. The packing is the stepper's.
class ElementRun {
 public:
  ElementRun(const std::vector<StraightSegment>& segments, const ElementTestOptions& options, const RunControl& control,
             const StepObserver& on_step, const Checkpointing& checkpointing)
      : segments_(segments),
        options_(options),
        on_step_(on_step),
        checkpointing_(checkpointing),
        N_(shear_direction(segments)),
        quasi_static_(options.drive.quasi_static_step > 0),
        watch_(control, quasi_static_ ? "quasi-static test" : "element test", "particle-steps"),
        stepper_(quasi_static_ ? make_quasi_static_stepper(segments, options, control.stop)
                               : make_time_stepper(segments, options)) {}

  void start(const State& state, const StepObserver& on_start) {
    stepper_->start(state);
    if (on_start) on_start(*stepper_, 0, 0);
    spheres_ = static_cast<double>(state.packing.size());
    at_.steps = stepper_->steps();
    take_row(segments_.empty() ? StraightSegment{} : segments_[0], 0);
  }

  void resume(Checkpoint from) {
    const auto refuse_if = [](bool wrong) {
      if (wrong) throw not_of_this_test();
    };
    refuse_if(from.segment < 0 || static_cast<std::size_t>(from.segment) >= segments_.size() || from.rows.empty());
    at_ = std::move(from);
    spheres_ = static_cast<double>(at_.state.packing.size());
    stepper_->resume(std::move(at_.state), at_.steps);
    refuse_if(at_.segment_steps < 1 || at_.segment_steps > stepper_->steps_of(at_.segment) ||
              at_.steps < at_.segment_steps);
    for (int i = 0; i < at_.segment; ++i) sheared_ += shear_length(segments_[static_cast<std::size_t>(i)]);
    for (std::size_t i = 0; i < at_.rows.size(); ++i) stepper_->judge(at_.rows[i], at_.rows[0], i, at_.rows[i].segment);
  }

  ElementTest run() {
    for (; static_cast<std::size_t>(at_.segment) < segments_.size(); ++at_.segment, at_.segment_steps = 0) {
      try {
        run_segment();
      } catch (const Interrupted&) {
        if (at_.segment_steps > 0) save();
        throw;
      }
    }
    ElementTest result;
    result.warnings = stepper_->warnings(at_.rows.size());
    result.steps = at_.steps;
    result.time_step = at_.time_step;
    result.seconds = seconds();
    result.rows = std::move(at_.rows);
    result.end = stepper_->state();
    return result;
  }

 private:
  const StraightSegment& segment() const { return segments_[static_cast<std::size_t>(at_.segment)]; }
  double seconds() const { return at_.seconds + seconds_since(began_); }

  void run_segment() {
    if (at_.segment_steps == 0) at_.segment_H = stepper_->motion().H;
    stepper_->enter(at_.segment, at_.segment_H, at_.segment_steps);
    at_.time_step = std::max(at_.time_step, stepper_->time_step());
    next_row_ = 1;
    if (at_.segment_steps > 0) {
      pass_rows();
      look();
    }
    for (const std::uint64_t steps = stepper_->steps_of(at_.segment); at_.segment_steps < steps;) {
      stepper_->step();
      ++at_.segment_steps;
      at_.steps = stepper_->steps();
      if (pass_rows()) take_row(segment(), stepper_->place());
      look();
    }
    sheared_ += shear_length(segment());
  }

  /// Whether rows of the segment have been reached since it was asked.
  bool pass_rows() {
    const int before = next_row_;
    while (next_row_ <= options_.rows && stepper_->reached(next_row_)) ++next_row_;
    return next_row_ != before;
  }

  void take_row(const StraightSegment& on, double e) {
    at_.rows.push_back(observe(stepper_->simulation(), stepper_->motion(), N_));
    fill_path(at_.rows.back(), on, at_.segment, e, sheared_);
    stepper_->judge(at_.rows.back(), at_.rows.front(), at_.rows.size() - 1, at_.segment);
  }

  /// What is not the run itself: the observer, progress, and saving.
  void look() {
    if (on_step_) on_step_(*stepper_, at_.segment, stepper_->place());
    watch_.tick(stepper_->fraction_done(), static_cast<double>(at_.steps) * spheres_);
    if (checkpointing_.save && seconds_since(saved_) >= checkpointing_.interval) save();
  }

  void save() {
    if (!checkpointing_.save) return;
    Checkpoint checkpoint = at_;
    checkpoint.state = stepper_->state();
    checkpoint.seconds = seconds();
    checkpointing_.save(checkpoint);
    saved_ = Clock::now();
  }

  const std::vector<StraightSegment>& segments_;
  const ElementTestOptions& options_;
  const StepObserver& on_step_;
  const Checkpointing& checkpointing_;
  Deviator<double> N_;
  bool quasi_static_;
  RunWatch watch_;
  std::unique_ptr<Stepper> stepper_;
  Checkpoint at_;  // where the run stands; its state is the stepper's
  double spheres_ = 0;
  int next_row_ = 1;    // of the segment
  double sheared_ = 0;  // shear path of the segments that are done
  Clock::time_point began_ = Clock::now(), saved_ = began_;
};

}  // namespace

ElementTest run_element_test(const State& start, const std::vector<StraightSegment>& segments,
                             const ElementTestOptions& options, const RunControl& control, const StepObserver& on_step,
                             const Checkpointing& checkpointing, const StepObserver& on_start) {
  check_options(start, options);
  ElementRun run(segments, options, control, on_step, checkpointing);
  run.start(start, on_start);
  return run.run();
}

ElementTest continue_element_test(Checkpoint from, const std::vector<StraightSegment>& segments,
                                  const ElementTestOptions& options, const RunControl& control,
                                  const StepObserver& on_step, const Checkpointing& checkpointing) {
  check_options(from.state, options);
  ElementRun run(segments, options, control, on_step, checkpointing);
  run.resume(std::move(from));
  return run.run();
}

void fill_path(Observation& row, const StraightSegment& segment, int index, double e, double sheared_before) {
  row.segment = index;
  set_strain(row, segment.strain(e));
  row.shear_path = sheared_before + segment.eps_dev_rate() * e;
  // after a reversal to the start only rounding is left: it has no direction
  if (row.eps_dev > 1e-12 * (row.shear_path + std::abs(row.eps_vol))) {
    row.shape_strain = shape_factor(row.strain.tensor);
    row.lode_strain = lode_angle(row.strain.tensor, segment.portable);
  }
}

double shear_length(const StraightSegment& segment) { return segment.eps_dev_rate() * segment.length; }

}  // namespace grainlaw::dem
