#include "predict/mixed_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "model/vocabulary/error.hpp"
#include "predict/path_integration.hpp"

namespace grainlaw::predict {
namespace {

constexpr std::size_t kSize = kUnknowns + 7;  // the law's, six strains, shear path
constexpr double kVanished = 1e-12;           // of the start's P: unjammed
constexpr double kDecay = 200;                // kappa, per unit of e, a strain: drift is gone after a percent of it
constexpr int kMostIterations = 60;
constexpr int kCornerIterations = 3;
constexpr double kNoReversal = 1e-6;  // of the stress ratio
constexpr double kSmall = 1e-13;      // of a residual over the moduli
constexpr double kDifference = 1e-7;  // of the free rates, for the tangent

/// State, strain (6, order of kComponentName) and shear path: what is integrated, and its rate.
struct ControlledState {
  LawState<double> law;
  Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
  double shear_path = 0;

  double nu(double nu_0) const { return nu_0 * std::exp(-strain.trace()); }  ///< where it is nu_0 at zero strain [-]
};

/// The rate of strain that keeps to a segment's conditions, and the rate of the law with it.
class ControlledRate {
 public:
  /// The arguments must outlive the object. `nu_0` is the volume fraction at zero strain, `start` the segment's.
  ControlledRate(const LawParameters<double>& parameters, Rung rung, Coupling coupling, const PathSegment& segment,
                 double nu_0, const ControlledState& start);

  /// d/de at path parameter `e`. Throws NotConverged when no free rates keep to the conditions.
  ControlledState operator()(double e, const ControlledState& y);

  /// The condition's quantity; by components stress_ij = P + sigma'_ij on the diagonal.
  static double value(const Condition& condition, const LawState<double>& state);

 private:
  using Free = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

  Eigen::Matrix3d strain_rate(const Free& a) const;
  LawState<double> law_rate_of(const LawState<double>& state, const Eigen::Matrix3d& D) const;
  Free residual(const LawState<double>& state, const Free& a, const Free& wanted) const;

  const LawParameters<double>& parameters_;
  Rung rung_;
  Coupling coupling_;
  const PathSegment& segment_;
  double nu_0_;
  Free values_at_start_, a_;
  LawModuli<double> moduli_{};  // at the place of the last call
};

/// Rate of the condition's quantity.
double rate_of(const Condition& condition, const LawState<double>& state, const LawState<double>& rate) {
  switch (condition.quantity) {
    case Condition::Quantity::P_star:
      return rate.P;
    case Condition::Quantity::stress: {
      const auto [i, j] = kComponentIndex.at(static_cast<std::size_t>(condition.free));
      return tensor_of(rate.sigma)(i, j) + (i == j ? rate.P : 0);
    }
    case Condition::Quantity::stress_ratio:
      break;
  }
  const double norm = state.sigma.norm();
  const double along = norm > 0 ? state.sigma.dot(rate.sigma) / norm : rate.sigma.norm();
  return (along - norm / state.P * rate.P) / state.P;
}

double ControlledRate::value(const Condition& condition, const LawState<double>& state) {
  if (condition.quantity == Condition::Quantity::P_star) return state.P;
  if (condition.quantity == Condition::Quantity::stress_ratio) return state.sigma.norm() / state.P;
  const auto [i, j] = kComponentIndex.at(static_cast<std::size_t>(condition.free));
  return tensor_of(state.sigma)(i, j) + (i == j ? state.P : 0);
}

ControlledRate::ControlledRate(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                               const PathSegment& segment, double nu_0, const ControlledState& start)
    : parameters_(parameters), rung_(rung), coupling_(coupling), segment_(segment), nu_0_(nu_0) {
  const auto count = static_cast<Eigen::Index>(segment.conditions.size());
  values_at_start_.resize(count);
  a_ = Free::Zero(count);
  for (Eigen::Index k = 0; k < count; ++k)
    values_at_start_(k) = value(segment.conditions[static_cast<std::size_t>(k)], start.law);
}

Eigen::Matrix3d ControlledRate::strain_rate(const Free& a) const {
  Eigen::Matrix3d D = segment_.direction.tensor;
  for (Eigen::Index k = 0; k < a.size(); ++k)
    D += a(k) * free_direction(segment_.conditions[static_cast<std::size_t>(k)]).tensor;
  return D;
}

LawState<double> ControlledRate::law_rate_of(const LawState<double>& state, const Eigen::Matrix3d& D) const {
  return law_rate(moduli_, parameters_, rung_, coupling_, state, law_direction(Eigen::Matrix3d(D + segment_.spin)));
}

ControlledRate::Free ControlledRate::residual(const LawState<double>& state, const Free& a, const Free& wanted) const {
  const LawState<double> rate = law_rate_of(state, strain_rate(a));
  Free r(a.size());
  for (Eigen::Index k = 0; k < a.size(); ++k)
    r(k) = rate_of(segment_.conditions[static_cast<std::size_t>(k)], state, rate) - wanted(k);
  return r;
}

ControlledState ControlledRate::operator()(double e, const ControlledState& y) {
  moduli_ = law_moduli(parameters_, y.nu(nu_0_), rung_);
  const Eigen::Index count = a_.size();
  Free wanted(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Condition& condition = segment_.conditions[static_cast<std::size_t>(k)];
    const double target = values_at_start_(k) + condition.rate * e;
    wanted(k) = condition.rate - kDecay * (value(condition, y.law) - target);
  }
  Free r = residual(y.law, a_, wanted);
  for (int iteration = 0; count > 0 && !(r.norm() <= kSmall * moduli_.B); ++iteration) {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> tangent(count, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      Free beside = a_;
      beside(k) += kDifference;
      tangent.col(k) = (residual(y.law, beside, wanted) - r) / kDifference;
    }
    const Free step = tangent.fullPivLu().solve(r);
    // halved until it helps: far from the solution the norm of the strain rate bends the residual
    double part = 1;
    Free next = a_ - step, r_next = residual(y.law, next, wanted);
    while (!(r_next.norm() < r.norm()) && part > 1e-6) {
      part /= 2;
      next = a_ - part * step;
      r_next = residual(y.law, next, wanted);
    }
    const bool stuck = !(r_next.norm() < r.norm());
    if (stuck && r.norm() <= 1e-9 * moduli_.B) break;  // as small as rounding lets it be
    if (stuck || iteration == kMostIterations)
      throw NotConverged(
          "no free strain rate keeps to the conditions; they ask for a stress that the state cannot carry");
    a_ = next;
    r = r_next;
  }
  const Eigen::Matrix3d D = strain_rate(a_);
  return {law_rate_of(y.law, D), D, deviatoric_norm(D)};
}

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

/// The state where the segment begins, of which a corner that turns the shear back is by all strains, the free ones too: these
/// depend in turn on whether it does.
ControlledState past_corner(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                            const PathSegment& segment, double nu_0, const ControlledState& before) {
  ControlledState from = before;
  for (int i = 0; i < kCornerIterations; ++i) {
    const Eigen::Matrix3d D = ControlledRate(parameters, rung, coupling, segment, nu_0, from)(0, from).strain;
    from.law = before.law;
    turn_corner(rung, from.law, law_direction(Eigen::Matrix3d(D + segment.spin)));
  }
  return from;
}

/// `segment` by a path parameter of the size of a strain, whatever unit its rates are given in.
PathSegment by_strain(PathSegment segment) {
  double unit = segment.direction.tensor.norm();
  for (const Condition& condition : segment.conditions) unit = std::max(unit, std::abs(condition.rate));
  if (!(unit > 0)) return segment;
  segment.direction.tensor /= unit;
  segment.spin /= unit;
  for (Condition& condition : segment.conditions) condition.rate /= unit;
  return segment;
}

/// Whether loading ends between corners, by the strain between rows: what has no event here (docs/theory/law.md, Events).
bool misses_a_reversal(const std::vector<PredictedRow>& rows, int segment) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i - 1].segment != segment || rows[i].segment != segment) continue;
    const LawDirection step = law_direction(StrainRate{rows[i].strain.tensor - rows[i - 1].strain.tensor});
    if (step.de > 0 && rows[i].state.P > 0 && reversal_value(rows[i].state, step) < -kNoReversal) return true;
  }
  return false;
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
    const PathSegment segment = by_strain(path.segments[k]);
    const int index = static_cast<int>(k);
    const auto add_row = [&](const ControlledState& at) {
      if (at.nu(path.nu) > kMaxVolumeFraction)
        fail(k, at, path.nu,
             fmt::format("is denser than nu = {}, which no packing is; give another extent or stress",
                         kMaxVolumeFraction));
      prediction.rows.push_back(row_of({index, Strain{at.strain}, at.shear_path, at.nu(path.nu)}, at.law, N));
    };
    const ControlledState from = past_corner(parameters, rung, coupling, segment, path.nu, y);
    // Once to see where it ends, once for the rows.
    ControlledWalk first(parameters, rung, coupling, segment, path.nu, from, P_floor, tolerances);
    const Arrival end = first.to(first.farthest());
    if (end.kind == Arrival::Kind::failed) fail(k, from, path.nu, end.message);
    if (end.kind == Arrival::Kind::reached && first.state().nu(path.nu) > kMaxVolumeFraction)
      fail(k, first.state(), path.nu,
           fmt::format(
               "{} = {} is not reached up to nu = {}, beyond which no packing is; if it lies behind the start, set "
               "\"reverse\"",
               to_string(segment.extent_kind), segment.extent, kMaxVolumeFraction));
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
  for (std::size_t k = 0; rung == Rung::memory && k < path.segments.size(); ++k) {
    if (misses_a_reversal(prediction.rows, static_cast<int>(k)))
      prediction.warnings.push_back(fmt::format(
          "loading ends within segments[{}], which the memory rung sees at corners only where stresses are given; end "
          "the segment there",
          k));
  }
  return prediction;
}

}  // namespace grainlaw::predict
