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
  double P_floor;
  const StraightSegment* segment = nullptr;
  LawDirection direction;

  LawState<double> rate(double e, LawState<double> state) const {
    // B jumps to zero at the jamming density; just above it is the limit that belongs to the jammed side.
    const double jammed = parameters->isotropic.pressure.nu_c * (1 + 4 * std::numeric_limits<double>::epsilon());
    state.P = std::max(state.P, P_floor);
    return evolution_rate(*parameters, coupling, state, std::max(segment->nu(e), jammed), direction);
  }
};

class PathIntegration {
 public:
  PathIntegration(const LawParameters<double>& parameters, Coupling coupling, const LawState<double>& start,
                  const Tolerances& tolerances)
      : law_{&parameters, coupling, kVanishedPressure * start.P, nullptr, {}},
        solver_(
            kUnknowns, tolerances,
            [this](double e, const double* y, double* rate) { pack(law_.rate(e, unpack(y)), rate); },
            [this](double, const double* y) { return y[0] - law_.P_floor; }),
        state_(start) {}

  void enter(const StraightSegment& segment, std::size_t index) {
    law_.segment = &segment;
    law_.direction = law_direction(segment.direction);
    index_ = index;
    at_corner_ = state_;
    e_ = 0;
    started_ = false;
    end_ = std::min(segment.length, jamming_point(segment, law_.parameters->isotropic.pressure.nu_c));
  }

  /// Moves on to path parameter `e` of the segment; false when the state unjams before.
  bool advance(double e) {
    if (e == e_) return true;
    if (e > end_) return false;
    if (e * law_.segment->direction.tensor.norm() <= kTinyStrain) {
      const LawState<double> rate = law_.rate(0, at_corner_);
      state_ = {at_corner_.P + e * rate.P, at_corner_.sigma + e * rate.sigma, at_corner_.F + e * rate.F};
      e_ = e;
      return state_.P > law_.P_floor;
    }
    Unknowns y;
    if (!started_) {
      pack(at_corner_, y.data());
      solver_.start(0, y, end_);
      started_ = true;
    }
    const Arrival arrival = solver_.advance(e, y);
    if (arrival.kind == Arrival::Kind::failed) {
      throw NotConverged(fmt::format(
          "segments[{}] at path parameter e = {:.9g} of {:.9g}, nu = {:.9g}: {}; give another tolerance or method",
          index_, arrival.t, law_.segment->length, law_.segment->nu(arrival.t), arrival.message));
    }
    state_ = unpack(y.data());
    e_ = arrival.t;
    return arrival.kind == Arrival::Kind::reached && state_.P > law_.P_floor;
  }

  const LawState<double>& state() const { return state_; }
  SolverStatistics statistics() const { return solver_.statistics(); }

 private:
  SegmentLaw law_;
  Cvode solver_;
  LawState<double> state_, at_corner_;
  std::size_t index_ = 0;
  double e_ = 0, end_ = 0;
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
    const double jammed_until = jamming_point(segments[k], parameters.isotropic.pressure.nu_c);
    for (; next < points.size() && points[next].segment == static_cast<int>(k) && !out.unjammed; ++next) {
      if (control.stop.stop_requested()) throw Interrupted("the prediction was interrupted");
      if (points[next].e < jammed_until && integration.advance(points[next].e)) {
        out.states.push_back(integration.state());
      } else {
        out.unjammed = true;
      }
    }
    if (next == points.size() || out.unjammed) break;
    out.unjammed = segments[k].length >= jammed_until || !integration.advance(segments[k].length);
  }
  out.statistics = integration.statistics();
  return out;
}

}  // namespace grainlaw::predict
