#pragma once
// model - data of one trajectory for values of some parameters, as the coupled fits of the rungs differentiate it.

#include <vector>

#include "fit/stages/trajectory.hpp"
#include "fit/statistics/problem.hpp"

namespace grainlaw::fit {

/// Misfits in this order, each over all rows: P*, then s along each of the first `axes` axes, then F along each.
struct TrajectoryMisfit {
  Trajectory trajectory;
  LawParameters<double> fixed;     ///< of all parameters that `index` does not name
  std::vector<std::size_t> index;  ///< in parameter_table(), of each free parameter
  Rung rung;
  Coupling coupling;
  double max_step;   ///< of the integration, deviatoric or volumetric strain [-]
  std::size_t axes;  ///< at most trajectory.axes.size()

  /// `x`: one value for each of `index`; `misfit`: rows x (1 + 2 axes). False where the law is not defined.
  template <class T>
  bool operator()(const T* x, T* misfit) const;
};

/// `misfit` with its derivatives.
decltype(ResidualBlock::evaluate) differentiated(const TrajectoryMisfit& misfit);

}  // namespace grainlaw::fit
