#pragma once
// Eqs. (17) and (18) on one test of shear at constant volume:
//   s(e) = s_max - (s_max - s_0) exp(-beta_s e),   F(e) = F_max - (F_max - F_0) exp(-beta_F e)
// s = <sigma',N>/P and F = <F',N> signed along the shear (norms are biased upwards in a finite packing), e the deviatoric
// strain, s_0 and F_0 measured in the first row. Windows and weights: shear_window() of data/shear_rows.hpp.

#include "fit/data/data_set.hpp"
#include "fit/statistics/stage_fit.hpp"

namespace grainlaw::fit {

/// Eqs. (17) and (18) on one constant-volume test, and its steady means.
struct ShearFit {
  std::string test;
  Mode mode = Mode::D2;
  std::uint64_t seed = 0;
  double nu = 0;                                        ///< volume fraction of the test [-]
  double lode = 0;                                      ///< l of its shear, LawDirection [-]
  double eps_dev_max = 0;                               ///< deviatoric strain reached [-]
  Estimate s_max, beta_s, F_max, beta_F;                ///< of the fits; one run, hence without standard error
  double s_0 = 0, F_0 = 0;                              ///< start values, measured in the first row [-]
  double s_steady = 0, F_steady = 0;                    ///< steady means; NaN when the test ends before steady_from [-]
  double C_star = 0, rattler_fraction = 0, P_star = 0;  ///< steady means, likewise [-]
  double steady_from = 0;                               ///< eps_dev from which these means are taken [-]
  double steady_since_s = 0, steady_since_F = 0,
         steady_since_P = 0;  ///< detected onsets, steady_onset(); NaN: none [-]
};
/// All but the Lode angle, which is that of the mode.
GRAINLAW_SOME_FIELDS(ShearFit, test, mode, seed, nu, eps_dev_max, s_0, F_0, s_steady, F_steady, C_star,
                     rattler_fraction, P_star, steady_from, steady_since_s, steady_since_F, steady_since_P, s_max,
                     beta_s, F_max, beta_F);

/// The problem of one quantity: parameters (limit, rate), one block.
struct SaturationProblem : Problem {
  std::vector<double> eps_dev, value, weight;  ///< rows of the block
};
SaturationProblem saturation_problem(const std::string& test, const std::string& quantity,
                                     const std::vector<double>& eps_dev, const std::vector<double>& value, double start,
                                     const CalibrationOptions& options);

/// True when rows show a limit and not only a slope: rate times strain reaches 0.5, and a straight line from `start` meets
/// them worse than the saturating curve does, twice its squared misfit at least (scatter must not pass for curvature).
bool shows_saturation(const std::vector<double>& eps_dev, const std::vector<double>& value,
                      const std::vector<double>& weight, double start, double rate, double squared_misfit);

/// One test; also appends its two misfits and costs to `stage`.
ShearFit fit_shear(const TestRecord& test, double nu_c, const CalibrationOptions& options, const RunControl& control,
                   Stage& stage);

/// All tests at constant volume, and the stage "shear" that sums them up. Tests at nu <= `nu_c`, Eq. (14)'s, leave the fit.
std::vector<ShearFit> fit_shear_tests(const DataSet& data, double nu_c, const CalibrationOptions& options,
                                      const RunControl& control, Stage& stage);

}  // namespace grainlaw::fit
