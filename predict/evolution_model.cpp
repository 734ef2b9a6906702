// Eq. (16) by CVODE, one initialisation for each straight segment: the jump of the direction at a corner is a boundary
// of the integration, never inside a step. Unknowns: P, sigma' (5), F' (5); independent variable: path parameter e.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "model/error.hpp"
#include "predict/cvode.hpp"
#include "predict/path_states.hpp"

namespace grainlaw::predict {
namespace {

constexpr std::size_t kUnknowns = 11;
using Unknowns = std::array<double, kUnknowns>;

// Up to this strain one explicit Euler step is exact to rounding: its error is (beta e)^2/2 < 1e-22 for beta < 1e2..1e3.
// It keeps the solver away from intervals that it cannot resolve (zero, one ulp, denormal).
constexpr double kTinyStrain = 1e-13;

// P below this part of its start counts as zero: the stress ratio sigma'/P has no meaning there.
constexpr double kVanishedPressure = 1e-12;

// Where sigma' stays finite the rate grows like 1/P and P vanishes as a square root, with a vertical tangent that no
// solver passes. Below this part of its start P is held fixed in the rate: from there to zero it takes a strain of some
// 1e-12, so that the place of the event does not notice.
constexpr double kHeldPressure = 1e-6;

LawState<double> unpack(const double* y) {
  return {y[0], Eigen::Map<const Deviator<double>>(y + 1), Eigen::Map<const Deviator<double>>(y + 6)};
}

void pack(const LawState<double>& state, double* y) {
  y[0] = state.P;
  Eigen::Map<Deviator<double>>(y + 1) = state.sigma;
  Eigen::Map<Deviator<double>>(y + 6) = state.F;
}

/// The law on one segment, continued harmlessly past the end of the jammed range, where trial steps of the solver look.
struct SegmentLaw {
  const LawParameters<double>* parameters;
  Coupling coupling;
  double P_start;
  const StraightSegment* segment = nullptr;
  LawDirection direction;

  double P_floor() const { return kVanishedPressure * P_start; }

  LawState<double> rate(double e, LawState<double> state) const {
    // B jumps to zero at the jamming density; just above it is the limit that belongs to the jammed side.
    const double jammed = parameters->isotropic.pressure.nu_c * (1 + 4 * std::numeric_limits<double>::epsilon());
    state.P = std::max(state.P, kHeldPressure * P_start);
    return evolution_rate(*parameters, coupling, state, std::max(segment->nu(e), jammed), direction);
  }
};

class PathIntegration {
 public:
  PathIntegration(const LawParameters<double>& parameters, Coupling coupling, const LawState<double>& start,
                  const Tolerances& tolerances)
      : law_{&parameters, coupling, start.P, nullptr, {}},
        solver_(
            kUnknowns, tolerances,
            [this](double e, const double* y, double* rate) { pack(law_.rate(e, unpack(y)), rate); },
            [this](double, const double* y) { return y[0] - law_.P_floor(); }),
        state_(start) {}

  void enter(const StraightSegment& segment, std::size_t index) {
    law_.segment = &segment;
    law_.direction = law_direction(segment.direction);
    index_ = index;
    at_corner_ = state_;
    e_ = 0;
    started_ = false;
    jammed_until_ = jamming_point(segment, law_.parameters->isotropic.pressure.nu_c);
  }

  /// Moves on to path parameter `e` of the segment, or to where the state unjams before; false then.
  bool advance(double e) {
    if (e == e_) return true;
    const double target = std::min(e, jammed_until_);
    if (target * law_.segment->direction.tensor.norm() <= kTinyStrain) {
      const LawState<double> rate = law_.rate(0, at_corner_);
      state_ = {at_corner_.P + target * rate.P, at_corner_.sigma + target * rate.sigma, at_corner_.F + target * rate.F};
      e_ = target;
      return e < jammed_until_ && state_.P > law_.P_floor();
    }
    Unknowns y;
    if (!started_) {
      pack(at_corner_, y.data());
      solver_.start(0, y, std::min(law_.segment->length, jammed_until_));
      started_ = true;
    }
    const Arrival arrival = solver_.advance(target, y);
    if (arrival.kind == Arrival::Kind::failed) throw NotConverged(describe(arrival));
    state_ = unpack(y.data());
    e_ = arrival.t;
    return arrival.kind == Arrival::Kind::reached && e < jammed_until_ && state_.P > law_.P_floor();
  }

  double place() const { return e_; }  // path parameter reached in the segment
  const LawState<double>& state() const { return state_; }
  SolverStatistics statistics() const { return solver_.statistics(); }

 private:
  std::string describe(const Arrival& failure) const {
    return fmt::format(
        "segments[{}] at path parameter e = {:.9g} of {:.9g}, nu = {:.9g}: {}; give another tolerance or method",
        index_, failure.t, law_.segment->length, law_.segment->nu(failure.t), failure.message);
  }

  SegmentLaw law_;
  Cvode solver_;
  LawState<double> state_, at_corner_;
  std::size_t index_ = 0;
  double e_ = 0, jammed_until_ = 0;
  bool started_ = false;
};

}  // namespace

PathStates evolution_states(const LawParameters<double>& parameters, Coupling coupling,
                            const std::vector<StraightSegment>& segments, const LawState<double>& start,
                            const std::vector<OutputPoint>& points, const Tolerances& tolerances,
                            const RunControl& control) {
  PathStates out;
  out.states.reserve(points.size());
  PathIntegration integration(parameters, coupling, start, tolerances);
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
