#pragma once
// The rate of strain that keeps to a segment's conditions, and the rate of the law with it; see mixed_control.hpp.

#include <Eigen/Dense>
#include <cmath>

#include "model/law.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::predict {

/// State, strain (6, order of kComponentName) and shear path: what is integrated, and its rate.
struct ControlledState {
  LawState<double> law;
  Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
  double shear_path = 0;

  double nu(double nu_0) const { return nu_0 * std::exp(-strain.trace()); }  ///< where it is nu_0 at zero strain [-]
};

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

}  // namespace grainlaw::predict
