// Tensor form of Eqs. (17) and (18) on a straight segment, q = sigma'/P, N the segment's direction:
//   q(e) = s_max N - (s_max N - q_0) exp(-beta_s e),   F'(e) = F_max N - (F_max N - F'_0) exp(-beta_F e)
// so that what does not lie along N decays. e is the deviatoric strain since the corner; parameters at the current nu.
// Under spin, dq/de = beta_s (s_max N - q) + W q - q W (law_state.hpp), and likewise F':
//   q(e) = q_inf + exp(-beta_s e) R (q_0 - q_inf) R^T,   beta_s q_inf - (W q_inf - q_inf W) = beta_s s_max N,   R = exp(W e)

#include "model/reduced_law.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "predict/path_walk.hpp"

namespace grainlaw::predict {
namespace {

/// sigma'/P and F' at a corner.
struct Ratios {
  Deviator<double> q = Deviator<double>::Zero(), F = Deviator<double>::Zero();
};

/// After path parameter `e` towards `limit` N, at `rate` per strain.
Deviator<double> saturating_tensor(double limit, const Deviator<double>& start, double rate, double e,
                                   const LawDirection& direction) {
  Deviator<double> end = limit * direction.N, left = start;
  if (!direction.spin.isZero(0)) {
    Eigen::Matrix<double, 5, 5> turning;
    for (Eigen::Index j = 0; j < 5; ++j)
      turning.col(j) = corotation(direction.spin, Deviator<double>(Deviator<double>::Unit(j)));
    const double per_e = rate * direction.de;
    if (per_e > 0)
      end = (per_e * turning.Identity() - turning).partialPivLu().solve(per_e * limit * direction.N).eval();
    left = rotated(start - end, direction.spin, e) + end;
  }
  return end - (end - left) * std::exp(-rate * (direction.de * e));
}

/// The closed form as walk() follows it. From where the state unjams or jams on, it begins anew from nothing.
class ReducedForm {
 public:
  /// The parameters must outlive the object.
  ReducedForm(const LawParameters<double>& parameters, const LawState<double>& start)
      : p_(parameters), nu_c_(parameters.isotropic.pressure.nu_c), corner_{start.sigma / start.P, start.F} {}

  void enter(const StraightSegment& segment, int index) {
    if (segment_) leave();
    segment_ = &segment;
    index_ = index;
    direction_ = law_direction(Eigen::Matrix3d(segment.direction.tensor + segment.spin));
    from_ = 0;
    // nu passes nu_c once in a segment, down where it was jammed and up where it was not
    crossing_ = std::max(std::log(nu_c_ / segment.nu_start) / direction_.dx, 0.0);
    crosses_ = (jammed_ ? direction_.dx < 0 : direction_.dx > 0) && crossing_ <= segment.length;
  }

  void advance(double e) {
    e_ = e;
    if (crosses_ && e >= crossing_) cross();
  }

  LawState<double> state() const {
    if (!jammed_) return {};
    const double nu = segment_->nu(e_), P = p_.isotropic.P_star(nu);
    const Ratios now = ratios_at(e_, nu);
    return {P, now.q * P, now.F};
  }

  static std::vector<LawState<double>> slopes() { return {}; }
  const std::vector<PathEvent>& events() const { return events_; }

 private:
  void cross() {
    events_.push_back({jammed_ ? EventKind::unjammed : EventKind::jammed, {index_, crossing_}, nu_c_});
    jammed_ = !jammed_;
    crosses_ = false;
    corner_ = {};
    from_ = crossing_;
  }

  void leave() {
    if (jammed_) corner_ = ratios_at(segment_->length, segment_->nu(segment_->length));
  }

  Ratios ratios_at(double e, double nu) const {
    const LawModuli<double> m = along(moduli_at(p_, nu), p_.lode, direction_);
    return {saturating_tensor(m.s_max, corner_.q, m.beta_s, e - from_, direction_),
            saturating_tensor(m.F_max, corner_.F, m.beta_F, e - from_, direction_)};
  }

  const LawParameters<double>& p_;
  double nu_c_;
  Ratios corner_;  // at from_ of the segment
  bool jammed_ = true;
  const StraightSegment* segment_ = nullptr;
  int index_ = 0;
  LawDirection direction_;
  double from_ = 0, e_ = 0;
  double crossing_ = 0;   // where nu passes nu_c,
  bool crosses_ = false;  // if it does so ahead
  std::vector<PathEvent> events_;
};

}  // namespace

PathStates reduced_states(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments,
                          const PathStart& start, const std::vector<OutputPoint>& points, const RunControl& control) {
  const auto states_of = [&](const LawParameters<double>& p, const LawState<double>& from) {
    ReducedForm form(p, from);
    return walk(form, segments, points, control);
  };
  PathStates out = states_of(parameters, start.state);
  if (start.steps.empty()) return out;
  const auto unjammed = std::ranges::find_if(out.states, [](const LawState<double>& state) { return !(state.P > 0); });
  out.slopes.assign(points.size(), std::vector(start.steps.size(), unknown_slope()));
  for (std::size_t k = 0; k < start.steps.size(); ++k) {
    const auto& [magnitude, h, above, below] = start.steps[k];
    const auto up = states_of(above, moved(start.state, h, start.slopes[k])).states;
    const auto down = states_of(below, moved(start.state, -h, start.slopes[k])).states;
    for (std::size_t i = 0; i < static_cast<std::size_t>(unjammed - out.states.begin()); ++i)
      out.slopes[i][k] = moved({}, 1 / (2 * h), moved(up[i], -1, down[i]));
  }
  return out;
}

}  // namespace grainlaw::predict
