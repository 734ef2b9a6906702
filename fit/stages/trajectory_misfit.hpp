#pragma once
// model - data of one trajectory for values of some parameters, as the coupled fits of the rungs differentiate it.

#include <vector>

#include "fit/stages/trajectory.hpp"

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
  bool operator()(const T* x, T* misfit) const {
    LawParameters<T> p = cast<T>(fixed);
    const auto field = fields(p);
    for (std::size_t k = 0; k < index.size(); ++k) *field[index[k]] = x[k];
    const std::size_t rows = trajectory.rows.size();
    return integrate<T>(trajectory, p, rung, coupling, max_step, [&](std::size_t i, const LawState<T>& y) {
      const LawState<double>& data = trajectory.rows[i].data;
      misfit[i] = y.P - data.P;
      for (std::size_t a = 0; a < axes; ++a) {
        const Deviator<T> n = trajectory.axes[a].template cast<T>();
        misfit[rows * (1 + a) + i] = y.sigma.dot(n) / y.P - data.sigma.dot(trajectory.axes[a]) / data.P;
        misfit[rows * (1 + axes + a) + i] = y.F.dot(n) - data.F.dot(trajectory.axes[a]);
      }
    });
  }
};

}  // namespace grainlaw::fit
