#include "fit/stages/evolution_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/stages/density_law_fit.hpp"
#include "fit/stages/shear_fit.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kFelt = 0.5;   // norm of weighted misfits below which a change of a parameter goes unnoticed
constexpr double kVague = 0.5;  // relative error beyond which a rate or a coupling is no number

struct Pair {
  const char *limit, *rate;
  ExponentialLaw<double> LawParameters<double>::*rate_law;
  bool of_stress;
};
constexpr std::array<Pair, 2> kPairs{{
    {"stress_ratio_max", "stress_rate", &LawParameters<double>::stress_rate, true},
    {"fabric_max", "fabric_rate", &LawParameters<double>::fabric_rate, false},
}};

void withdraw(StageFit& fit, const std::string& law, const std::string& note) {
  if (fit.find(law + ".Q_limit") < 0) return;  // held, the stage before has said why
  for (const char* part : {".Q_limit", ".Q_c", ".alpha"}) fit.mark_not_identified(law + part, note);
}

/// Densities at which shear at constant volume goes on for long enough to tell the limit from the slope. `channel` of the
/// trajectory's block, 1 for the stress ratio and 1 + axes for the fabric, is the component along the first axis.
std::vector<double> saturating_densities(const StageFit& fit, const std::vector<Trajectory>& trajectories,
                                         const LawParameters<double>& law, const Pair& pair) {
  std::vector<double> nu;
  Eigen::Index first = 0;
  for (const Trajectory& t : trajectories) {
    const auto rows = static_cast<Eigen::Index>(t.rows.size()), axes = static_cast<Eigen::Index>(t.axes.size());
    const Eigen::Index at = first + rows * (pair.of_stress ? 1 : 1 + axes);
    first += rows * (1 + 2 * axes);
    if (rows == 0 || !t.constant_volume()) continue;
    const auto along = [&](const LawState<double>& y) {
      return pair.of_stress ? y.sigma.dot(t.axes[0]) / y.P : y.F.dot(t.axes[0]);
    };
    std::vector<double> e, value, weight;
    for (const TrajectoryRow& row : t.rows) {
      e.push_back(t.direction.de * row.e);
      value.push_back(along(row.data));
      weight.push_back(row.weight);
    }
    const Eigen::Map<const Eigen::VectorXd> w(weight.data(), rows);
    const double misfit = w.cwiseProduct(fit.solution.misfit.segment(at, rows)).squaredNorm();
    const double rate = (law.*pair.rate_law).value(t.nu_start, law.shear_nu_c);
    if (shows_saturation(e, value, weight, along(t.start), rate, misfit)) nu.push_back(t.nu_start);
  }
  return nu;
}

void judge_pair(StageFit& fit, const std::vector<Trajectory>& trajectories, const LawParameters<double>& law,
                const Pair& pair, const CalibrationOptions& options) {
  // What a change of all rates by the same factor would do.
  const Eigen::Index i = fit.find(std::string(pair.rate) + ".Q_limit");
  if (i < 0) return;  // held
  const Solution& solution = fit.solution;
  const double Q_limit = solution.x(i), Q_c = solution.x(i + 1), alpha = solution.x(i + 2);
  const Eigen::VectorXd felt =
      solution.weight.cwiseProduct(solution.jacobian.col(i) * Q_limit + solution.jacobian.col(i + 1) * Q_c);
  const std::string too_little = fmt::format(
      "there is too little {} to see how fast it grows; use larger packings or lower densities", pair.limit);
  if (felt.norm() < kFelt) {
    withdraw(fit, pair.rate, too_little);
    return;
  }
  std::vector<double> nu = saturating_densities(fit, trajectories, law, pair);
  if (const int found = distinct_densities(nu); found < kDensitiesNeeded) {
    const std::string note =
        fmt::format("saturation shown at {} of at least {} densities; shear at more densities, each to eps_dev >= {:g}",
                    found, kDensitiesNeeded, options.steady_from);
    withdraw(fit, pair.limit, note);
    withdraw(fit, pair.rate, note);
    return;
  }
  std::sort(nu.begin(), nu.end());
  const double y = nu[nu.size() / 2] / law.shear_nu_c - 1, decay = std::exp(-alpha * y);
  const Eigen::Vector3d slope(1, decay, -Q_c * decay * y);
  const double error = std::sqrt(std::max(0.0, slope.dot(fit.covariance().block<3, 3>(i, i) * slope)));
  if (error > kVague * (Q_limit + Q_c * decay)) withdraw(fit, pair.rate, too_little);
}

}  // namespace

void check_evolution(const std::vector<Trajectory>& trajectories, const LawParameters<double>& law,
                     const CalibrationOptions& options, StageFit& fit) {
  for (const ShearQuantity& quantity : kShearQuantities) settle_constant_law(fit, quantity.name);
  for (const Pair& pair : kPairs) judge_pair(fit, trajectories, law, pair, options);
}

void check_coupling(const std::string& name, const std::string& remedy, StageFit& fit) {
  const Eigen::Index k = fit.find(name);
  const double scale = std::max(std::abs(fit.solution.x(k)), parameter_table()[parameter_index(name)].start);
  const bool felt = fit.solution.weight.cwiseProduct(fit.solution.jacobian.col(k)).norm() * scale >= kFelt;
  if (!felt || fit.influence.row(k).norm() > kVague * scale) {
    fit.mark_not_identified(name, "too little fabric on the paths that change the volume; " + remedy);
  }
}

}  // namespace grainlaw::fit
