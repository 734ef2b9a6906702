#include "fit/stages/trajectory_misfit.hpp"

#include <ceres/jet.h>

namespace grainlaw::fit {

template <class T>
bool TrajectoryMisfit::operator()(const T* x, T* misfit) const {
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

decltype(ResidualBlock::evaluate) differentiated(const TrajectoryMisfit& misfit) {
  // Eight derivatives a pass. The memory rung has as many parameters, the evolution twice; wider dual numbers are not faster and
  // keep the compiler busy for longer (docs/performance.md).
  const std::size_t rows = misfit.trajectory.rows.size() * (1 + 2 * misfit.axes);
  return differentiated<ceres::Jet<double, 8>>(misfit, static_cast<int>(misfit.index.size()), static_cast<int>(rows));
}

}  // namespace grainlaw::fit
