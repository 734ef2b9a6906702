// Eq. (16), with or without memory, by CVODE, one initialisation for each straight segment: the jump of the direction at a corner is a boundary
// of the integration, never inside a step, and so is the jump of a reversal. Unknowns: those of SegmentLaw; independent variable: path parameter e.

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "model/error.hpp"
#include "predict/cvode.hpp"
#include "predict/path_states.hpp"
#include "predict/segment_law.hpp"

namespace grainlaw::predict {
namespace {

// Up to this strain one explicit Euler step is exact to rounding: its error is (beta e)^2/2 < 1e-22 for beta < 1e2..1e3.
// It keeps the solver away from intervals that it cannot resolve (zero, one ulp, denormal).
constexpr double kTinyStrain = 1e-13;

// P below this part of its start counts as zero: the stress ratio sigma'/P has no meaning there.
constexpr double kVanishedPressure = 1e-12;

// Where sigma' stays finite the rate grows like 1/P and P vanishes as a square root, with a vertical tangent that no
// solver passes. Below this part of its start P is held fixed in the rate: from there to zero it takes a strain of some
// 1e-12, so that the place of the event does not notice.
constexpr double kHeldPressure = 1e-6;

class PathIntegration {
 public:
  PathIntegration(const LawParameters<double>& parameters, Rung rung, Coupling coupling, const LawState<double>& start,
                  const Tolerances& tolerances)
      : parameters_(parameters),
        rung_(rung),
        coupling_(coupling),
        P_held_(kHeldPressure * start.P),
        P_floor_(kVanishedPressure * start.P),
        solver_(
            kUnknowns, tolerances, [this](double e, const double* y, double* rate) { law_->rate(e, y, rate); },
            [this](double e, const double* y) { return law_->state_of(e, y).P - P_floor_; },
            [this](double e, const double* y, double* scale) { law_->scale(e, y, scale); }),
        state_(start) {}

  void enter(const StraightSegment& segment, std::size_t index) {
    law_.emplace(parameters_, rung_, coupling_, segment, P_held_);
    index_ = index;
    turn_corner(rung_, state_, law_->direction());
    at_corner_ = law_->unknowns_of(0, state_);
    e_ = 0;
    started_ = false;
    jammed_until_ = rung_ == Rung::memory ? std::numeric_limits<double>::infinity()
                                          : jamming_point(segment, parameters_.isotropic.pressure.nu_c);
  }

  /// Moves on to path parameter `e` of the segment, or to where the state unjams before; false then.
  bool advance(double e) {
    if (e == e_) return true;
    const double target = std::min(e, jammed_until_);
    Unknowns y = at_corner_;
    if (target * (law_->segment().direction.tensor + law_->segment().spin).norm() <= kTinyStrain) {
      Unknowns rate;
      law_->rate(0, y.data(), rate.data());
      for (std::size_t i = 0; i < kUnknowns; ++i) y[i] += target * rate[i];
      e_ = target;
      state_ = law_->state_of(e_, y.data());
      return e < jammed_until_ && state_.P > P_floor_;
    }
    if (!started_) {
      solver_.start(0, y, std::min(law_->segment().length, jammed_until_));
      started_ = true;
    }
    const Arrival arrival = solver_.advance(target, y);
    if (arrival.kind == Arrival::Kind::failed) throw NotConverged(describe(arrival));
    e_ = arrival.t;
    state_ = law_->state_of(e_, y.data());
    return arrival.kind == Arrival::Kind::reached && e < jammed_until_ && state_.P > P_floor_;
  }

  double place() const { return e_; }  // path parameter reached in the segment
  const LawState<double>& state() const { return state_; }
  SolverStatistics statistics() const { return solver_.statistics(); }

 private:
  std::string describe(const Arrival& failure) const {
    return fmt::format(
        "segments[{}] at path parameter e = {:.9g} of {:.9g}, nu = {:.9g}: {}; give another tolerance or method",
        index_, failure.t, law_->segment().length, law_->segment().nu(failure.t), failure.message);
  }

  const LawParameters<double>& parameters_;
  Rung rung_;
  Coupling coupling_;
  double P_held_, P_floor_;
  std::optional<SegmentLaw> law_;  // of the segment entered last
  Cvode solver_;
  LawState<double> state_;
  Unknowns at_corner_{};
  std::size_t index_ = 0;
  double e_ = 0, jammed_until_ = 0;
  bool started_ = false;
};

}  // namespace

PathStates integrated_states(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                             const std::vector<StraightSegment>& segments, const LawState<double>& start,
                             const std::vector<OutputPoint>& points, const Tolerances& tolerances,
                             const RunControl& control) {
  PathStates out;
  out.states.reserve(points.size());
  PathIntegration integration(parameters, rung, coupling, start, tolerances);
  std::size_t next = 0;
  for (std::size_t k = 0; k < segments.size() && next < points.size() && !out.unjammed; ++k) {
    integration.enter(segments[k], k);
    for (; next < points.size() && points[next].segment == static_cast<int>(k) && !out.unjammed; ++next) {
      if (control.stop.stop_requested()) throw Interrupted("the prediction was interrupted");
      out.unjammed = !integration.advance(points[next].e);
      if (!out.unjammed) out.states.push_back(integration.state());
    }
    if (next < points.size() && !out.unjammed) out.unjammed = !integration.advance(segments[k].length);
    if (out.unjammed) out.unjammed_at = {static_cast<int>(k), integration.place()};
  }
  out.statistics = integration.statistics();
  return out;
}

}  // namespace grainlaw::predict
