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

constexpr double kNoCorner = 1e-3;  // between unit directions

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

/// The closed form along the path. From where the state unjams or jams on, it begins anew from nothing.
class ReducedForm {
 public:
  /// The parameters must outlive the object.
  ReducedForm(const LawParameters<double>& parameters, const LawState<double>& start)
      : p_(parameters), nu_c_(parameters.isotropic.pressure.nu_c), corner_{start.sigma / start.P, start.F} {}

  void enter(const StraightSegment& segment, int index) {
    const Eigen::Matrix3d L = segment.direction.tensor + segment.spin, unit = L / L.norm();
    if (segment_ != nullptr && (unit - leg_).norm() <= kNoCorner) {  // one leg in parts
      from_ = (from_ - segment_->length) * (segment_->direction.tensor + segment_->spin).norm() / L.norm();
    } else {
      if (segment_) leave();
      from_ = 0;
      leg_ = unit;
    }
    segment_ = &segment;
    index_ = index;
    direction_ = path_direction(L);
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
  Ratios corner_;  // at from_ of the segment, below zero where the leg began before it
  bool jammed_ = true;
  const StraightSegment* segment_ = nullptr;
  int index_ = 0;
  Eigen::Matrix3d leg_ = Eigen::Matrix3d::Zero();  // direction at the last corner
  LawDirection direction_;
  double from_ = 0, e_ = 0;
  double crossing_ = 0;   // where nu passes nu_c,
  bool crosses_ = false;  // if it does so ahead
  std::vector<PathEvent> events_;
};

/// The closed form with those of moved parameters beside it, whose differences are the slopes.
class ReducedForms {
 public:
  /// `parameters` and `start` must outlive the object.
  ReducedForms(const LawParameters<double>& parameters, const PathStart& start)
      : start_(start), form_(parameters, start.state) {
    for (std::size_t k = 0; k < start.steps.size(); ++k) {
      const auto& [magnitude, h, above, below] = start.steps[k];
      above_.emplace_back(above, moved(start.state, h, start.slopes[k]));
      below_.emplace_back(below, moved(start.state, -h, start.slopes[k]));
    }
  }

  void enter(const StraightSegment& segment, int index) {
    for_each([&](ReducedForm& form) { form.enter(segment, index); });
  }
  void advance(double e) {
    for_each([&](ReducedForm& form) { form.advance(e); });
  }

  LawState<double> state() const { return form_.state(); }
  const std::vector<PathEvent>& events() const { return form_.events(); }

  std::vector<LawState<double>> slopes() {
    known_ = known_ && form_.state().P > 0;
    std::vector<LawState<double>> slopes(start_.steps.size(), unknown_slope());
    for (std::size_t k = 0; k < slopes.size() && known_; ++k)
      slopes[k] = moved({}, 1 / (2 * start_.steps[k].h), moved(above_[k].state(), -1, below_[k].state()));
    return slopes;
  }

 private:
  template <class Move>
  void for_each(const Move& move) {
    move(form_);
    for (auto* forms : {&above_, &below_}) std::for_each(forms->begin(), forms->end(), move);
  }

  const PathStart& start_;
  ReducedForm form_;
  std::vector<ReducedForm> above_, below_;
  bool known_ = true;  // until the first point where it is unjammed
};

}  // namespace

WalkedPath walk_reduced(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments,
                        const PathStart& start, const std::vector<OutputPoint>& points, const RunControl& control,
                        const PathVisitor& visit) {
  ReducedForms forms(parameters, start);
  return walk(forms, segments, points, control, visit);
}

}  // namespace grainlaw::predict
