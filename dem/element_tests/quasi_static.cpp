#include "dem/element_tests/stepper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace grainlaw::dem {
namespace {

constexpr double kMaxAffineSteps = 1e9;  // per segment: years of work; beyond it a step was mistyped

class QuasiStaticStepper : public Stepper {
 public:
  QuasiStaticStepper(const std::vector<StraightSegment>& segments, const ElementTestOptions& options,
                     const std::stop_token& stop)
      : segments_(segments), options_(options), for_sums_(options.engine) {
    minimising_.stop = stop;  // the run itself reports
    for_sums_.precision = Precision::reference;
    for (const StraightSegment& segment : segments) strain_of_path_ += strain_of(segment);
  }

  void start(const State& state) override {
    state_ = state;
    state_.ledger.E_start = settle(state_).E_after;
  }

  void resume(State state, std::uint64_t steps) override {
    state_ = std::move(state);
    passes_ = steps;
  }

  std::uint64_t steps_of(int segment) const override {
    return quasi_static_steps(segments_[static_cast<std::size_t>(segment)], options_.drive, options_.rows);
  }

  void enter(int segment, const Eigen::Matrix3d& H_0, std::uint64_t done) override {
    strain_before_ = 0;
    for (int k = 0; k < segment; ++k) strain_before_ += strain_of(segments_[static_cast<std::size_t>(k)]);
    segment_ = &segments_[static_cast<std::size_t>(segment)];
    steps_of_segment_ = steps_of(segment);
    H_0_ = H_0;
    done_ = done;
    place_ = place_after(done);
  }

  /// The cell and the spheres in it one affine step on, then equilibrium.
  void step() override {
    const double e = place_after(done_ + 1);
    State next = state_;
    const Eigen::Vector3d stretch = stretch_of(*segment_, e);
    next.packing.H = stretch.asDiagonal() * H_0_;
    Ledger ledger = state_.ledger;
    const double E_pot = ledger.E_start + ledger.W_box - ledger.D_contact;
    const Relaxation settled = settle(next);
    ledger.W_box += settled.E_before - E_pot;
    ledger.D_contact += settled.E_before - settled.E_after;
    next.ledger = ledger;
    next.step = passes_;
    next.time = strain_at(e) / options_.drive.strain_rate;
    state_ = std::move(next);
    seen_.reset();
    ++done_;
    place_ = e;
  }

  double place() const override { return place_; }

  bool reached(int row) const override {
    return done_ >= steps_of_segment_ / static_cast<std::uint64_t>(options_.rows) * static_cast<std::uint64_t>(row);
  }

  double fraction_done() const override { return strain_at(place_) / strain_of_path_; }
  std::uint64_t steps() const override { return passes_; }
  double time_step() const override { return 0; }

  Simulation& simulation() override {
    if (!seen_) seen_.emplace(state_, for_sums_, motion());
    return *seen_;
  }

  CellMotion motion() const override { return {state_.packing.H, Eigen::Matrix3d::Zero(), Transport::homogeneous}; }
  const State& state() override { return state_; }

  void judge(const Observation&, const Observation&, std::size_t, int) override {}  // the ledger balances by its making

  std::vector<std::string> warnings(std::size_t) const override {
    if (unsettled_ == 0) return {};
    return {fmt::format("{} minimisations stopped short of equilibrium after {} force passes", unsettled_,
                        options_.relax.max_passes)};
  }

 private:
  Relaxation settle(State& state) {
    const Relaxation settled = relax(state, options_.engine, options_.relax, minimising_);
    passes_ += static_cast<std::uint64_t>(settled.passes);
    if (!settled.relaxed) ++unsettled_;
    return settled;
  }

  /// e after so many steps of the segment.
  double place_after(std::uint64_t steps) const {
    const double length = segment_->length;
    return steps == steps_of_segment_ ? length
                                      : length * static_cast<double>(steps) / static_cast<double>(steps_of_segment_);
  }

  /// max(|eps_vol|, eps_dev) summed along the path up to e of the segment.
  double strain_at(double e) const { return strain_before_ + strain_of(*segment_) * e / segment_->length; }

  const std::vector<StraightSegment>& segments_;
  const ElementTestOptions& options_;
  RunControl minimising_;
  EngineOptions for_sums_;          // over contacts, in double
  State state_;                     // in equilibrium
  std::optional<Simulation> seen_;  // the state with its contacts, when somebody asked for it
  double strain_of_path_ = 0;
  const StraightSegment* segment_ = nullptr;  // along which it goes
  double strain_before_ = 0;                  // of the segments before
  std::uint64_t steps_of_segment_ = 0, done_ = 0;
  Eigen::Matrix3d H_0_ = Eigen::Matrix3d::Identity();
  double place_ = 0;                          // e [-]
  std::uint64_t passes_ = 0, unsettled_ = 0;  // of all minimisations; of them those that stopped short
};

}  // namespace

std::uint64_t quasi_static_steps(const StraightSegment& segment, const DriveOptions& drive, int rows) {
  const double per_row = std::ceil(strain_of(segment) / rows / drive.quasi_static_step * (1 - 1e-12));
  if (!(per_row * rows <= kMaxAffineSteps)) {
    throw InvalidInput(
        fmt::format("quasi_static_step: at {} a segment would take {:.3g} minimisations; give a larger one",
                    drive.quasi_static_step, per_row * rows));
  }
  return static_cast<std::uint64_t>(std::max(1.0, per_row)) * static_cast<std::uint64_t>(rows);
}

std::unique_ptr<Stepper> make_quasi_static_stepper(const std::vector<StraightSegment>& segments,
                                                   const ElementTestOptions& options, const std::stop_token& stop) {
  return std::make_unique<QuasiStaticStepper>(segments, options, stop);
}

}  // namespace grainlaw::dem
