#include "predict/mixed_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "model/vocabulary/error.hpp"
#include "predict/controlled_rate.hpp"
#include "predict/path_integration.hpp"

namespace grainlaw::predict {
namespace {

constexpr std::size_t kSize = kUnknowns + 7;  // the law's, six strains, shear path
constexpr double kVanished = 1e-12;           // of the start's P: unjammed

void put(const ControlledState& y, double* out) {
  pack(y.law, out);
  for (std::size_t c = 0; c < 6; ++c) out[kUnknowns + c] = y.strain(kComponentIndex[c][0], kComponentIndex[c][1]);
  out[kSize - 1] = y.shear_path;
}

ControlledState taken(const double* y) {
  ControlledState state{unpacked(y), {}, y[kSize - 1]};
  for (std::size_t c = 0; c < 6; ++c) {
    const auto [i, j] = kComponentIndex[c];
    state.strain(i, j) = state.strain(j, i) = y[kUnknowns + c];
  }
  return state;
}

/// What the segment's extent measures.
double progress(const PathSegment& segment, const ControlledState& start, const ControlledState& y, double nu_0) {
  switch (segment.extent_kind) {
    case ExtentKind::eps_dev:
      return y.shear_path - start.shear_path;
    case ExtentKind::eps_vol:
      return std::abs((y.strain - start.strain).trace());
    case ExtentKind::target_nu:
      return y.nu(nu_0);
    case ExtentKind::target_eps_dev:
      return deviatoric_norm(y.strain);
    case ExtentKind::target_P_star:
      return y.law.P;
    case ExtentKind::target_stress_ratio:
      break;
  }
  return y.law.sigma.norm() / y.law.P;
}

/// One segment of the path under the law.
class ControlledWalk {
 public:
  ControlledWalk(const LawParameters<double>& parameters, Rung rung, Coupling coupling, const PathSegment& segment,
                 double nu_0, const ControlledState& start, double P_floor, const Tolerances& tolerances)
      : segment_(segment),
        nu_0_(nu_0),
        start_(start),
        P_floor_(P_floor),
        nu_jamming_(rung == Rung::memory ? 0 : parameters.isotropic.pressure.nu_c),
        sense_(progress(segment, start, start, nu_0) < segment.extent ? 1 : -1),
        rate_(parameters, rung, coupling, segment, nu_0, start),
        solver_(
            kSize, tolerances, [this](double e, const double* y, double* out) { put(rate_(e, taken(y)), out); },
            [this](double, const double* y) { return std::min(jammed_margin(taken(y)), goal_margin(taken(y))); }) {
    put(start, y_.data());
    // a step of the free rates' first choice has a norm: the path parameter by which the strain is certainly too large
    const double first = rate_(0, start).strain.norm();
    solver_.start(0, y_, kMostStrain / std::max(first, 1e-12));
    e_end_ = kMostStrain / std::max(first, 1e-12);
  }

  /// To path parameter `e`, or to what comes first.
  Arrival to(double e) { return solver_.advance(std::min(e, e_end_), y_); }

  ControlledState state() const { return taken(y_.data()); }
  double farthest() const { return e_end_; }
  /// Whether that was what unjams the state and not the segment's end.
  bool unjammed() const { return jammed_margin(state()) < goal_margin(state()); }
  SolverStatistics statistics() const { return solver_.statistics(); }

 private:
  double jammed_margin(const ControlledState& y) const {
    const double margin = std::min(y.law.P - P_floor_, least_principal_stress(y.law.P, y.law.sigma));
    return nu_jamming_ > 0 ? std::min(margin, y.nu(nu_0_) - nu_jamming_) : margin;
  }
  double goal_margin(const ControlledState& y) const {
    return sense_ * (segment_.extent - progress(segment_, start_, y, nu_0_));
  }

  const PathSegment& segment_;
  double nu_0_;
  ControlledState start_;
  double P_floor_;
  double nu_jamming_;  // where Eq. (16) ends; zero: nowhere
  double sense_;       // whether the extent is reached from below
  ControlledRate rate_;
  Cvode solver_;
  std::array<double, kSize> y_{};
  double e_end_ = 0;
};

[[noreturn]] void fail(std::size_t index, const ControlledState& at, double nu_0, const std::string& why) {
  throw NotConverged(fmt::format("segments[{}] at nu = {:.6g}, eps_dev = {:.6g}, P* = {:.6g}, s_dev = {:.6g}: {}",
                                 index, at.nu(nu_0), deviatoric_norm(at.strain), at.law.P,
                                 at.law.sigma.norm() / at.law.P, why));
}

/// N of the first direction with a deviator, before free rates.
Deviator<double> shear_direction_of(const Path& path) {
  for (const PathSegment& segment : path.segments) {
    const LawDirection direction = law_direction(segment.direction);
    if (direction.de > 0) return direction.N;
  }
  return Deviator<double>::Zero();
}

}  // namespace

Prediction predict_by_law(Rung rung, const LawParameters<double>& parameters, Coupling coupling, const Path& path,
                          const LawState<double>& start, int per_segment, const Tolerances& tolerances,
                          const ValidRange& range, const RunControl& control) {
  check(path);
  if (rung == Rung::reduced)
    throw InvalidInput(
        "the reduced law is a closed form of the strain; ask evolution or memory where stresses are given");
  const auto before = std::chrono::steady_clock::now();
  const Deviator<double> N = shear_direction_of(path);
  const double P_floor = kVanished * start.P;
  Prediction prediction;
  prediction.model = rung;
  ControlledState y{start, Eigen::Matrix3d::Zero(), 0};
  for (std::size_t k = 0; k < path.segments.size() && prediction.events.empty(); ++k) {
    const PathSegment& segment = path.segments[k];
    const int index = static_cast<int>(k);
    const auto add_row = [&](const ControlledState& at) {
      prediction.rows.push_back(row_of({index, Strain{at.strain}, at.shear_path, at.nu(path.nu)}, at.law, N));
    };
    ControlledState from = y;
    turn_corner(rung, from.law, law_direction(Eigen::Matrix3d(segment.direction.tensor + segment.spin)));
    // Once to see where it ends, once for the rows.
    ControlledWalk first(parameters, rung, coupling, segment, path.nu, from, P_floor, tolerances);
    const Arrival end = first.to(first.farthest());
    if (end.kind == Arrival::Kind::failed) fail(k, from, path.nu, end.message);
    if (end.kind == Arrival::Kind::reached)
      fail(k, first.state(), path.nu,
           fmt::format("{} = {} is not reached within a strain of {}; give another extent or direction",
                       to_string(segment.extent_kind), segment.extent, kMostStrain));
    add_row(from);
    ControlledWalk second(parameters, rung, coupling, segment, path.nu, from, P_floor, tolerances);
    for (int i = 1; i < per_segment; ++i) {
      if (control.stop.stop_requested()) throw Interrupted("the prediction was interrupted");
      const Arrival arrival = second.to(end.t * i / per_segment);
      if (arrival.kind != Arrival::Kind::reached) fail(k, from, path.nu, arrival.message);
      add_row(second.state());
    }
    y = first.state();
    const SolverStatistics s = first.statistics(), t = second.statistics();
    prediction.statistics.steps += s.steps + t.steps;
    prediction.statistics.rhs_evaluations += s.rhs_evaluations + t.rhs_evaluations;
    prediction.statistics.restarts += 2;
    if (first.unjammed()) {
      const bool tension = y.law.P > 2 * P_floor && least_principal_stress(y.law.P, y.law.sigma) <= 1e-9 * y.law.P;
      prediction.events.push_back({tension ? EventKind::tension : EventKind::unjammed, {index, end.t}, y.nu(path.nu)});
    } else {
      add_row(y);
    }
  }
  conclude(prediction, range, before);
  return prediction;
}

}  // namespace grainlaw::predict
