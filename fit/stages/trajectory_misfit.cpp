#include "fit/stages/trajectory_misfit.hpp"

#include <ceres/jet.h>

#include "fit/statistics/problem.hpp"

namespace grainlaw::fit {
namespace {

// The derivatives of one pass. The memory rung has as many parameters, the evolution twice; wider dual numbers are not faster and keep
// the compiler busy for longer (docs/performance.md).
using Jet = ceres::Jet<double, 8>;

struct Evaluation {
  TrajectoryMisfit of;

  /// `x`: one value for each of `index`.
  template <class T>
  bool operator()(const T* x, T* misfit) const {
    LawParameters<T> p = cast<T>(of.fixed);
    const auto field = fields(p);
    for (std::size_t k = 0; k < of.index.size(); ++k) *field[of.index[k]] = x[k];
    const std::vector<TrajectoryRow>& rows = of.trajectory.rows;
    return integrate<T>(of.trajectory, p, of.rung, of.coupling, of.max_step, [&](std::size_t i, const LawState<T>& y) {
      const LawState<double>& data = rows[i].data;
      misfit[i] = y.P - data.P;
      for (std::size_t a = 0; a < of.axes; ++a) {
        const Deviator<double>& axis = of.trajectory.axes[a];
        const Deviator<T> n = axis.template cast<T>();
        misfit[rows.size() * (1 + a) + i] = y.sigma.dot(n) / y.P - data.sigma.dot(axis) / data.P;
        misfit[rows.size() * (1 + of.axes + a) + i] = y.F.dot(n) - data.F.dot(axis);
      }
    });
  }
};

}  // namespace

std::function<bool(const double* x, double* misfit, double* jacobian)> differentiated(const TrajectoryMisfit& misfit) {
  const std::size_t rows = misfit.trajectory.rows.size() * (1 + 2 * misfit.axes);
  return differentiated<Jet>(Evaluation{misfit}, static_cast<int>(misfit.index.size()), static_cast<int>(rows));
}

}  // namespace grainlaw::fit
