#pragma once
// Eqs. (17) and (18) on one test of shear at constant volume:
//   s(e) = s_max - (s_max - s_0) exp(-beta_s e),   F(e) = F_max - (F_max - F_0) exp(-beta_F e)
// s = <sigma',N>/P and F = <F',N> signed along the shear (norms are biased upwards in a finite packing), e the deviatoric
// strain, s_0 and F_0 measured in the first row. Windows and weights: shear_window.hpp.

#include "fit/data/data_set.hpp"
#include "fit/statistics/stage_fit.hpp"

namespace grainlaw::fit {

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
