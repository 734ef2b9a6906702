#pragma once
// A stretch of a test along one straight segment, as the evolution stage sees it: a start, a direction, rows to meet.
//   d(state)/de = law_rate(...) of Eq. (16), with or without memory, e the segment's path parameter
// Integrated from row to row by Butcher's explicit Runge-Kutta method of order 6 (7 stages; J. Aust. Math. Soc. 4, 1964)
// at fixed steps: the error is smooth in the parameters, as derivatives through it must be, and at the default step below
// 1e-8. Each segment starts from the state measured at its first row (ISO unloading: from Eq. (14), of which Eq. (16) is
// the derivative there), not from the model's end of the segment before: Eq. (16) lacks the dilatancy of shear at constant
// volume (P up to a third too low), and that misfit must not enter what follows through the stress ratio sigma'/P.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "fit/data/data_set.hpp"
#include "model/law.hpp"

namespace grainlaw::fit {

/// Row of a trajectory.
struct TrajectoryRow {
  double e = 0;           ///< path parameter since the start of the trajectory [-]
  LawState<double> data;  ///< measured
  double weight = 0;      ///< of its window, before division by the scale of a quantity
};

struct Trajectory {
  std::string test;
  int cluster = 0;
  int segment = 0;
  Branch branch = Branch::unloading;  ///< on which the test starts
  bool starts_on_law =
      false;  ///< P by Eq. (14) at nu_start, else all of `start`, whose fabric is NaN if the test tells none
  LawState<double> start;  ///< measured; s_r the measured ratio at the reversal before, if any
  double nu_start = 0;     ///< [-]
  /// Strain since the start of the test, compression positive [-].
  Deviator<double> dev_start = Deviator<double>::Zero();
  double vol_start = 0;
  LawDirection direction;              ///< per unit of e
  std::vector<Deviator<double>> axes;  ///< orthonormal; deviators are compared along these, the first one is N of s_par
  std::vector<TrajectoryRow> rows;     ///< that enter, e ascending
  int excluded = 0;                    ///< rows of the segment that do not

  double nu(double e) const { return nu_start * std::exp(direction.dx * e); }  ///< volume fraction at e [-]
  /// Strain at e, since the start of the test [-].
  double eps_dev(double e) const { return (dev_start + direction.N * (direction.de * e)).norm(); }
  double eps_vol(double e) const { return vol_start + direction.dx * e; }

  bool constant_volume() const { return direction.de > 0 && std::abs(direction.dx) <= 1e-12 * direction.de; }
};

/// Trajectories of all tests of `data`: ISO unloading with nu >= iso_nu_min and every segment of a test with shear. Rows
/// at nu <= nu_c (`nu_c` of Eq. (14)) and what follows them on the segment leave, unjammed rows too. Throws InvalidInput
/// naming test and row when rows are not on the test's path.
std::vector<Trajectory> trajectories_of(const DataSet& data, double nu_c, const CalibrationOptions& options);

namespace detail {

template <class T>
LawState<T> combination(const LawState<T>& y, double h, const std::array<LawState<T>, 7>& k,
                        const std::array<double, 7>& a, std::size_t stages) {
  LawState<T> sum = y;
  for (std::size_t i = 0; i < stages; ++i) {
    if (a[i] == 0) continue;
    const double c = h * a[i];  // plain: a dual number times a dual number is three times the work
    for_each_part(
        [c]<class Part>(const StatePart& part, Part& of_sum, const Part& of_k) {
          if constexpr (std::is_same_v<Part, T>) {
            if (part.has_rate) of_sum += of_k * c;
          }
        },
        sum, k[i]);
    // the same number of all deviators, then the next: one deviator after the other takes a third longer
    for (Eigen::Index j = 0; j < Deviator<T>::SizeAtCompileTime; ++j) {
      for_each_part(
          [c, j]<class Part>(const StatePart& part, Part& of_sum, const Part& of_k) {
            if constexpr (!std::is_same_v<Part, T>) {
              if (part.has_rate) of_sum(j) += of_k(j) * c;
            }
          },
          sum, k[i]);
    }
  }
  return sum;
}

}  // namespace detail

/// Where a step looks at the right-hand side, as fractions of the step, and which of these places each stage takes.
inline constexpr std::array<double, 5> kStepNodes{0, 1. / 3, 2. / 3, 1. / 2, 1};
inline constexpr std::array<std::size_t, 7> kStageNode{0, 1, 2, 1, 3, 3, 4};

/// One step of size `h` from `y`; `rate(node, y)` is the right-hand side at kStepNodes[node] of the step. What `k` holds is overwritten; it
/// is handed in, as to make it anew for each step takes a thirtieth of a fit. Flattened: left to themselves,
/// compilers call each of the small sums and products of dual numbers, which takes three times as long (docs/performance.md).
template <class T, class Rate>
GRAINLAW_FLATTEN LawState<T> butcher6_step(const Rate& rate, double h, const LawState<T>& y,
                                           std::array<LawState<T>, 7>& k) {
  static constexpr std::array<std::array<double, 7>, 7> a{{{},
                                                           {1. / 3},
                                                           {0, 2. / 3},
                                                           {1. / 12, 1. / 3, -1. / 12},
                                                           {-1. / 16, 9. / 8, -3. / 16, -3. / 8},
                                                           {0, 9. / 8, -3. / 8, -3. / 4, 1. / 2},
                                                           {9. / 44, -9. / 11, 63. / 44, 18. / 11, 0, -16. / 11}}};
  static constexpr std::array<double, 7> b{11. / 120, 0, 27. / 40, 27. / 40, -4. / 15, -4. / 15, 11. / 120};
  for (std::size_t i = 0; i < 7; ++i) k[i] = rate(kStageNode[i], detail::combination(y, h, k, a[i], i));
  return detail::combination(y, h, k, b, 7);
}

/// The law along the trajectory; `visit(i, state)` is called for each row in order. False when the state leaves P > 0.
template <class T, class Visit>
bool integrate(const Trajectory& trajectory, const LawParameters<T>& p, Rung rung, Coupling coupling, double max_step,
               const Visit& visit) {
  LawState<T> y = cast<T>(trajectory.start);
  if (trajectory.starts_on_law) y.P = p.isotropic.P_star(trajectory.nu_start);
  std::array<LawModuli<T>, kStepNodes.size()> moduli;
  moduli.fill(law_moduli(p, trajectory.nu_start, rung));
  const auto rate = [&](std::size_t node, const LawState<T>& state) {
    return law_rate(moduli[node], p, rung, coupling, state, trajectory.direction);
  };
  const double strain_rate = std::max(trajectory.direction.de, std::abs(trajectory.direction.dx));
  std::array<LawState<T>, 7> k;
  double e = 0;
  for (std::size_t i = 0; i < trajectory.rows.size(); ++i) {
    const double to = trajectory.rows[i].e;
    const int steps = std::max(1, static_cast<int>(std::ceil((to - e) * strain_rate / max_step)));
    const double h = (to - e) / steps;
    for (int step = 0; step < steps; ++step) {
      if (!(y.P > 0.0)) return false;
      if (trajectory.direction.dx != 0) {
        moduli.front() = moduli.back();  // the end of the step before
        for (std::size_t node = 1; node < moduli.size(); ++node) {
          moduli[node] = law_moduli(p, trajectory.nu(e + (step + kStepNodes[node]) * h), rung);
        }
      }
      y = butcher6_step<T>(rate, h, y, k);
    }
    if (!(y.P > 0.0)) return false;
    e = to;
    visit(i, y);
  }
  return true;
}

}  // namespace grainlaw::fit
