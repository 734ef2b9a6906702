#include "fit/stages/evolution_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fit/stages/density_law_fit.hpp"
#include "fit/stages/density_series.hpp"
#include "fit/statistics/profile.hpp"
#include "fit/stages/shear_fit.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kFelt = 0.5;             // norm of weighted misfits below which a change of a parameter goes unnoticed
constexpr double kVague = 0.5;            // relative error beyond which a rate or a coupling is no number
constexpr double kVolumetricPath = 1e-3;  // |d eps_vol| of a trajectory that says something about the coupling

struct Pair {
  const char *limit, *rate;
  ExponentialLaw<double> LawParameters<double>::*rate_law;
  bool of_stress;
};
constexpr std::array<Pair, 2> kPairs{{
    {"stress_ratio_max", "stress_rate", &LawParameters<double>::stress_rate, true},
    {"fabric_max", "fabric_rate", &LawParameters<double>::fabric_rate, false},
}};

Eigen::Index index_of(const StageFit& fit, const std::string& name) {
  for (std::size_t k = 0; k < fit.stage.estimates.size(); ++k) {
    if (fit.stage.estimates[k].name == name) return static_cast<Eigen::Index>(k);
  }
  return -1;
}

void withdraw(StageFit& fit, const std::string& law, const std::string& note) {
  if (index_of(fit, law + ".Q_limit") < 0) return;  // held, the stage before has said why
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
    if (rows == 0 || t.direction.de == 0 || std::abs(t.direction.dx) > 1e-12) continue;
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
  const Eigen::Index i = index_of(fit, std::string(pair.rate) + ".Q_limit");
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

/// a2 or a0, by the same two measures.
void judge_coupling(StageFit& fit, const std::string& name, const std::string& remedy) {
  const Eigen::Index k = index_of(fit, name);
  const double scale = std::max(std::abs(fit.solution.x(k)), parameter_table()[parameter_index(name)].start);
  const bool felt = fit.solution.weight.cwiseProduct(fit.solution.jacobian.col(k)).norm() * scale >= kFelt;
  if (!felt || fit.influence.row(k).norm() > kVague * scale) {
    fit.mark_not_identified(name, "too little fabric on the paths that change the volume; " + remedy);
  }
}

/// sigma_N/(B F_N) of a test's steady rows.
struct RatioOfTest {
  int packing = 0, rows = 0;
  double sum = 0;
  double mean() const { return sum / rows; }
};

std::string window_text(const CalibrationOptions& options) {
  return fmt::format(
      "all trajectories, each segment from its measured start: P* of ISO unloading (nu >= {:g}, start on Eq. (14)) "
      "relative, scale {:g}; s_par scale {:g} and F_par scale {:g} in shear, at constant volume 0 < eps_dev <= {:g} "
      "and, with {:g} times the weight, eps_dev >= {:g}, elsewhere all rows; P* in shear is shown without weight "
      "because Eq. (16) has no dilatancy",
      options.iso_nu_min, options.pressure_scale, options.stress_scale, options.fabric_scale, options.rate_window,
      options.steady_weight, options.steady_from);
}

}  // namespace

std::vector<std::string> evolution_parameters(Coupling coupling, const std::vector<std::string>& held) {
  std::vector<std::string> names{"pressure.p0", "pressure.gamma_p", "pressure.nu_c"};
  const auto is_free = [&](const std::string& name) { return std::find(held.begin(), held.end(), name) == held.end(); };
  for (const std::string law : {"stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate"}) {
    if (!is_free(law)) continue;
    for (const char* part : {".Q_limit", ".Q_c", ".alpha"}) names.push_back(law + part);
  }
  const std::string anisotropy = coupling == Coupling::energy ? "anisotropy.a2" : "anisotropy.a0";
  if (is_free(anisotropy)) names.push_back(anisotropy);
  return names;
}

bool contains_anisotropy(const std::vector<Trajectory>& trajectories) {
  return std::any_of(trajectories.begin(), trajectories.end(), [](const Trajectory& t) {
    return !t.axes.empty() && !t.rows.empty() && std::abs(t.direction.dx) * t.rows.back().e > kVolumetricPath;
  });
}

StageFit fit_evolution(const std::vector<Trajectory>& trajectories, LawParameters<double>& law,
                       std::vector<std::string> held, const CalibrationOptions& options, const RunControl& control,
                       const FoundErrors& found) {
  const bool energy = options.coupling == Coupling::energy;
  const std::string coupling = energy ? "anisotropy.a2" : "anisotropy.a0";
  const bool anisotropy = contains_anisotropy(trajectories);
  if (!anisotropy) held.push_back(coupling);
  const std::vector<std::string> free = evolution_parameters(options.coupling, held);
  const EvolutionProblem problem = evolution_problem(trajectories, law, free, options);
  StageFit fit = fit_stage("evolution", window_text(options), problem.parameters, problem.blocks,
                           "the trajectories do not determine it; test more densities, and D2 to steady state",
                           options.threads, control, {options.loss, options.starts});
  const std::string remedy =
      "add a test that shears and then changes the volume, e.g. D2 to eps_dev = 0.15 and then ISO "
      "to nu + 0.03 and back";
  if (fit.solution.defined) {
    const auto field = fields(law);
    for (std::size_t k = 0; k < problem.parameters.size(); ++k) {
      *field[parameter_index(problem.parameters[k].name)] = fit.solution.x(static_cast<Eigen::Index>(k));
    }
    inherit_error(
        {"coordination", "rattlers"}, found, law,
        [&](const LawParameters<double>& given) {
          return evolution_problem(trajectories, given, free, options).blocks;
        },
        options.threads, fit);
    for (const ShearQuantity& quantity : kShearQuantities) settle_constant_law(fit, quantity.name);
    for (const Pair& pair : kPairs) judge_pair(fit, trajectories, law, pair, options);
    if (anisotropy) judge_coupling(fit, coupling, remedy);
    if (options.profiles) profile_doubtful(problem.parameters, problem.blocks, options.threads, control, fit);
  }
  if (!anisotropy) fit.stage.estimates.push_back({coupling, {0, std::nan(""), Status::not_identified, remedy}});
  return fit;
}

TiedCoupling tied_a1(const std::vector<Trajectory>& trajectories, const LawParameters<double>& law, const Estimate& a2,
                     const Eigen::RowVectorXd& influence_on_a2, const CalibrationOptions& options) {
  TiedCoupling tied{{}, Eigen::RowVectorXd::Zero(influence_on_a2.size())};
  Estimate& a1 = tied.a1;
  a1.note = "follows from a2 by A1 = (2/3)(A2 - sigma_dev): " + a2.note;
  if (a2.status == Status::not_identified) return tied;
  std::map<std::string, RatioOfTest> ratios;
  for (const Trajectory& t : trajectories) {
    if (t.direction.de == 0 || std::abs(t.direction.dx) > 1e-12) continue;
    const double B = law.isotropic.B_star(t.nu_start);
    for (const TrajectoryRow& row : t.rows) {
      const double F = row.data.F.dot(t.direction.N);
      if (t.direction.de * row.e < options.steady_from || !(F > 0)) continue;
      RatioOfTest& ratio = ratios[t.test];
      ratio.packing = t.cluster;
      ratio.sum += row.data.sigma.dot(t.direction.N) / (B * F);
      ++ratio.rows;
    }
  }
  if (ratios.empty()) {
    a1.note = "no steady shear to refer it to; shear to eps_dev >= " + fmt::format("{:g}", options.steady_from);
    return tied;
  }
  const double n = static_cast<double>(ratios.size());
  double mean = 0;
  for (const auto& [test, ratio] : ratios) mean += ratio.mean() / n;
  std::map<int, double> off;  // of the mean, by what each packing added to it
  for (const auto& [test, ratio] : ratios) off[ratio.packing] += (ratio.mean() - mean) / n;
  a1.value = 2. / 3 * (a2.value - mean);
  a1.status = Status::tied;
  a1.note = fmt::format("mean of A1/(B F) over steady shear of {} tests, A1 = (2/3)(A2 - sigma_dev)", ratios.size());
  if (!std::isfinite(a2.standard_error) || off.size() < 2) return tied;
  const double packings = static_cast<double>(off.size()), few = std::sqrt(packings / (packings - 1));
  tied.influence = 2. / 3 * influence_on_a2;
  for (const auto& [packing, part] : off) tied.influence(packing) -= 2. / 3 * few * part;
  a1.standard_error = tied.influence.norm();
  a1.degrees_of_freedom = std::min(a2.degrees_of_freedom, packings - 1);
  return tied;
}

}  // namespace grainlaw::fit
