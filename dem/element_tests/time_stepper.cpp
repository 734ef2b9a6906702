#include "dem/element_tests/stepper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dem/element_tests/energy_watch.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kMaxTimeSteps = 1e12;  // per segment: years of work; beyond it a rate was mistyped
constexpr double kIsostatic = 6;        // contacts of a sphere that bears load; with fewer no packing is rigid, and no flow quasi-static

/// The state as a new run sees it: clock and accelerations forgotten, the ledger is opened later.
State fresh(State state) {
  state.step = 0;
  state.time = 0;
  for (auto* a : {&state.ax, &state.ay, &state.az, &state.ref_x, &state.ref_y, &state.ref_z}) a->clear();
  return state;
}

/// Forces for a velocity gradient that has jumped.
Simulation restarted(Simulation& sim, const CellMotion& motion) {
  State state = sim.take_state();
  for (auto* a : {&state.ax, &state.ay, &state.az}) a->clear();
  return Simulation(std::move(state), sim.options(), motion);
}

class TimeStepper : public Stepper {
 public:
  TimeStepper(const std::vector<StraightSegment>& segments, const ElementTestOptions& options)
      : segments_(segments), options_(options) {}

  void start(const State& state) override {
    CellMotion motion{state.packing.H, Eigen::Matrix3d::Zero(), options_.drive.transport};
    if (!segments_.empty()) motion = motion_at(make_drive(segments_[0], options_.drive, state.packing.H), 0);
    start_engine(fresh(state), motion);
    sim_->open_ledger();
  }

  void resume(State state, std::uint64_t steps) override {
    if (state.ax.empty() || state.ref_x.empty()) throw not_of_this_test();
    const CellMotion motion{state.packing.H, Eigen::Matrix3d::Zero(), options_.drive.transport};
    start_engine(std::move(state), motion);
    steps_ = steps;
  }

  std::uint64_t steps_of(int segment) const override {
    return steps_along(make_drive(segments_[static_cast<std::size_t>(segment)], options_.drive, sim_->cell()));
  }

  void enter(int segment, const Eigen::Matrix3d& H_0, std::uint64_t done) override {
    drive_ = make_drive(segments_[static_cast<std::size_t>(segment)], options_.drive, H_0);
    steps_of_drive_ = steps_along(drive_);
    done_ = done;
    const double dt = drive_.duration / static_cast<double>(steps_of_drive_);
    if (segment > 0 && done == 0) sim_ = restarted(*sim_, motion_at(drive_, 0));
    sim_->set_dt(dt);
    place_ = path_parameter(drive_, time_after(done));
  }

  void step() override {
    motion_ = motion_at(drive_, time_after(done_ + 1));
    sim_->advance(motion_at(drive_, (static_cast<double>(done_) + 0.5) * sim_->dt()), motion_);
    ++done_;
    ++steps_;
    place_ = path_parameter(drive_, time_after(done_));
  }

  double place() const override { return place_; }

  bool reached(int row) const override {
    const double length = drive_.segment.length;
    return place_ >= (row == options_.rows ? length : length * row / options_.rows);
  }

  double fraction_done() const override { return static_cast<double>(steps_) / steps_of_path_; }
  std::uint64_t steps() const override { return steps_; }
  double time_step() const override { return sim_->dt(); }
  Simulation& simulation() override { return *sim_; }
  CellMotion motion() const override { return motion_; }

  const State& state() override { return sim_->state(); }

  void judge(const Observation& row, const Observation& first, std::size_t index, int segment) override {
    const double residual = energy_.residual(row, first);
    imbalance_.note(residual, options_.warn_energy_residual, row.nu);
    if (row.C_star >= kIsostatic) rate_.note(row.inertial_number, options_.warn_inertial_number, row.nu);
    if (residual <= options_.stop_energy_residual) return;
    throw Error(fmt::format(
        "energy balance: residual {:.3g} at row {} (segment {}, nu = {:.6g}, step {}) is beyond {}; the results would "
        "be wrong, give a smaller time_step_fraction than {}, a smaller strain_rate, or relax the spheres",
        residual, index + 1, segment, row.nu, steps_, options_.stop_energy_residual,
        options_.engine.time_step_fraction));
  }

  std::vector<std::string> warnings(std::size_t rows) const override {
    std::vector<std::string> all;
    imbalance_.report(all, "energy residual", options_.warn_energy_residual, rows);
    rate_.report(all, "inertial number", options_.warn_inertial_number, rows);
    return all;
  }

 private:
  void start_engine(State state, const CellMotion& motion) {
    motion_ = motion;
    sim_.emplace(std::move(state), options_.engine, motion);
    engine_dt_ = sim_->dt();
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      steps_of_path_ += static_cast<double>(steps_of(static_cast<int>(k)));
    }
  }

  std::uint64_t steps_along(const Drive& drive) const {
    const double steps = std::ceil(drive.duration / engine_dt_ * (1 - 1e-12));
    if (!(steps <= kMaxTimeSteps)) {
      throw InvalidInput(fmt::format("strain_rate: at {} 1/s a segment would take {:.3g} steps; give a larger one",
                                     options_.drive.strain_rate, steps));
    }
    return static_cast<std::uint64_t>(std::max(1.0, steps));
  }

  /// Since the start of the segment, after so many of its steps [s].
  double time_after(std::uint64_t steps) const {
    return steps == steps_of_drive_ ? drive_.duration : static_cast<double>(steps) * sim_->dt();
  }

  const std::vector<StraightSegment>& segments_;
  const ElementTestOptions& options_;
  std::optional<Simulation> sim_;  // once the run has begun
  double engine_dt_ = 0;           // the largest that a step may have [s]
  double steps_of_path_ = 0;
  std::uint64_t steps_ = 0;           // taken since the start of the test
  Drive drive_;                       // along this segment
  std::uint64_t steps_of_drive_ = 0;  // of this segment
  std::uint64_t done_ = 0;            // of them
  CellMotion motion_;                 // after the last step
  double place_ = 0;                  // e after it [-]
  EnergyWatch energy_;
  Excess imbalance_, rate_;
};

}  // namespace

std::unique_ptr<Stepper> make_time_stepper(const std::vector<StraightSegment>& segments,
                                           const ElementTestOptions& options) {
  return std::make_unique<TimeStepper>(segments, options);
}

}  // namespace grainlaw::dem
