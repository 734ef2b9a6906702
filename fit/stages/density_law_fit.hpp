#pragma once
// Eq. (20), Q(nu) = Q_limit + Q_c exp(-alpha (nu/nu_c - 1)), over the values that the shear tests gave for s_max, beta_s,
// F_max and beta_F. nu_c is given, not fitted: it is degenerate with Q_c and alpha. Each value weighs by the law's magnitude
// there so far (at least a fifth of the mean), since rates scatter in proportion to their size.

#include "fit/data/density_series.hpp"
#include "fit/stages/shear_fit.hpp"
#include "fit/stages/stage.hpp"

namespace grainlaw::fit {

/// One of the four limits and rates of a shear test.
struct ShearQuantity {
  const char* name;              ///< of the law in parameter_table(), e.g. "stress_ratio_max"
  Estimate ShearFit::*estimate;  ///< where the test has it
  ExponentialLaw<double> LawParameters<double>::*law;
};
extern const std::array<ShearQuantity, 4> kShearQuantities;

inline constexpr int kDensitiesNeeded = 3;  ///< for the three parameters of a law

/// A law without decaying part (Q_c on its bound 0) is a constant: alpha then is fixed, without effect, and not unknown.
void settle_constant_law(StageFit& fit, const std::string& law);

/// Stage of the quantity's name over the tests in which it is fitted, one block of one row each; `cluster` of each test, its
/// packing. Starts from the best of a few alpha with Q_limit and Q_c linear in between. With fewer than three densities its
/// parameters are not identified (the curve still meets the values there are).
StageDefinition density_law_stage(const ShearQuantity& quantity, const std::vector<ShearFit>& shear,
                                  const std::vector<int>& cluster, double nu_c, const CalibrationOptions& options);

}  // namespace grainlaw::fit
