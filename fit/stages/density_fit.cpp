#include "fit/stages/density_fit.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/statistics/inherited_error.hpp"
#include "fit/statistics/profile.hpp"

namespace grainlaw::fit {
namespace {

using Jet3 = ceres::Jet<double, 3>;
using Jet2 = ceres::Jet<double, 2>;
using Jet1 = ceres::Jet<double, 1>;

/// One block per series; `datum` is what the model is compared with, for the scale of the report only.
template <class Jet, class Misfit, class Datum>
std::vector<ResidualBlock> blocks_of(const std::vector<DensitySeries>& series, const std::string& quantity,
                                     int parameters, const Misfit& misfit, const Datum& datum) {
  std::vector<ResidualBlock> blocks;
  for (const DensitySeries& s : series) {
    const int rows = static_cast<int>(s.points.size());
    ResidualBlock block;
    block.test = s.test;
    block.cluster = s.cluster;
    block.weight = Eigen::VectorXd::Ones(rows);
    Channel channel{quantity, 0, rows, s.excluded, 0};
    for (const DensityPoint& p : s.points) channel.max_abs_data = std::max(channel.max_abs_data, std::abs(datum(p)));
    block.channels.push_back(channel);
    block.evaluate = differentiated<Jet>(
        [points = s.points, misfit](const auto* x, auto* values) {
          for (std::size_t i = 0; i < points.size(); ++i) values[i] = misfit(points[i], x);
          return true;
        },
        parameters, rows);
    blocks.push_back(std::move(block));
  }
  return blocks;
}

FreeParameter below_data(const std::string& name, double start, const std::vector<DensitySeries>& series) {
  FreeParameter nu_c = free_parameter(name, start);
  nu_c.upper = std::max(nu_c.lower, std::min(nu_c.upper, least_nu(series) - kNearestJamming));
  return nu_c;
}

std::vector<double> densities(const std::vector<DensitySeries>& series) {
  std::vector<double> nu;
  for (const DensitySeries& s : series) {
    for (const DensityPoint& p : s.points) nu.push_back(p.nu);
  }
  return nu;
}

void require_densities(StageFit& fit, const std::vector<DensitySeries>& series, int needed) {
  const int found = distinct_densities(densities(series));
  if (found >= needed) return;
  const std::vector<NamedEstimate> parameters = fit.stage.estimates;
  for (const NamedEstimate& p : parameters) {
    fit.mark_not_identified(p.name, fmt::format("{} of at least {} densities; test more densities", found, needed));
  }
}

/// d misfit/d parameter, row by row.
template <class Slope>
Eigen::VectorXd slope_of(const std::vector<DensitySeries>& series, const Slope& slope) {
  std::vector<double> values;
  for (const DensitySeries& s : series) {
    for (const DensityPoint& p : s.points) values.push_back(slope(p));
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Of a fit of Eq. (11) or (14), whose third parameter is nu_c.
void inherit_nu_c(const StageFit& first, const Eigen::VectorXd& slope, StageFit& second) {
  inherit_error(slope, first.influence.row(2), first.stage.estimates[2].estimate.degrees_of_freedom, second);
}

const char* const kMoreDensities = "the rows do not determine it; test more densities";

}  // namespace

DensityProblem coordination_problem(const std::string& prefix, const std::vector<DensitySeries>& series,
                                    const Coordination<double>& start) {
  DensityProblem problem;
  problem.parameters = {free_parameter(prefix + "coordination.C1", start.C1),
                        free_parameter(prefix + "coordination.alpha", start.alpha),
                        below_data(prefix + "coordination.nu_c", start.nu_c, series)};
  problem.blocks = blocks_of<Jet3>(
      series, "C_star", 3,
      [](const DensityPoint& p, const auto* x) {
        using T = std::decay_t<decltype(*x)>;
        return Coordination<T>{x[0], x[1], x[2]}.C_star(p.nu) - p.C_star;
      },
      [](const DensityPoint& p) { return p.C_star; });
  return problem;
}

DensityProblem rattlers_problem(const std::string& prefix, const std::vector<DensitySeries>& series,
                                const Rattlers<double>& start, double nu_c) {
  DensityProblem problem;
  problem.parameters = {free_parameter(prefix + "rattlers.phi_c", start.phi_c),
                        free_parameter(prefix + "rattlers.phi_v", start.phi_v)};
  problem.blocks = blocks_of<Jet2>(
      series, "rattler_fraction", 2,
      [nu_c](const DensityPoint& p, const auto* x) {
        using T = std::decay_t<decltype(*x)>;
        return Rattlers<T>{x[0], x[1]}.fraction(p.nu, T(nu_c)) - p.rattler_fraction;
      },
      [](const DensityPoint& p) { return p.rattler_fraction; });
  return problem;
}

DensityProblem pressure_problem(const std::string& prefix, const std::vector<DensitySeries>& series,
                                const Pressure<double>& start) {
  DensityProblem problem;
  problem.parameters = {free_parameter(prefix + "pressure.p0", start.p0),
                        free_parameter(prefix + "pressure.gamma_p", start.gamma_p),
                        below_data(prefix + "pressure.nu_c", start.nu_c, series)};
  problem.blocks = blocks_of<Jet3>(
      series, "P_scaled", 3,
      [](const DensityPoint& p, const auto* x) {
        using T = std::decay_t<decltype(*x)>;
        return Pressure<T>{x[0], x[1], x[2]}.scaled(p.nu) - x[2] * (p.P_star / (p.nu * p.C()));
      },
      [nu_c = start.nu_c](const DensityPoint& p) { return nu_c * p.P_star / (p.nu * p.C()); });
  return problem;
}

std::vector<StageFit> fit_state_law(const std::string& prefix, const std::vector<DensitySeries>& series,
                                    const std::string& window, StateLaw<double>& law, const CalibrationOptions& options,
                                    const RunControl& control) {
  std::vector<StageFit> fits;
  std::vector<DensityProblem> problems;
  const auto run = [&](const std::string& stage, DensityProblem problem, int densities_needed) -> StageFit& {
    fits.push_back(fit_stage(prefix + stage, window + ", rows unweighted", problem.parameters, problem.blocks,
                             kMoreDensities, options.threads, control, {options.loss}));
    require_densities(fits.back(), series, densities_needed);
    problems.push_back(std::move(problem));
    return fits.back();
  };
  // Starts below the data, whatever the caller's guess of the jamming density was.
  const double highest_nu_c = least_nu(series) - 0.005;
  law.coordination.nu_c = std::min(law.coordination.nu_c, highest_nu_c);
  law.pressure.nu_c = std::min(law.pressure.nu_c, highest_nu_c);

  const StageFit& C = run("coordination", coordination_problem(prefix, series, law.coordination), 3);
  law.coordination = {C.solution.x(0), C.solution.x(1), C.solution.x(2)};
  const StageFit& phi = run("rattlers", rattlers_problem(prefix, series, law.rattlers, law.coordination.nu_c), 2);
  law.rattlers = {phi.solution.x(0), phi.solution.x(1)};
  inherit_nu_c(fits[0],
               slope_of(series,
                        [&](const DensityPoint& p) {
                          const double nu_c = law.coordination.nu_c;
                          return law.rattlers.fraction(p.nu, nu_c) * law.rattlers.phi_v * p.nu / (nu_c * nu_c);
                        }),
               fits[1]);
  const StageFit& P = run("pressure", pressure_problem(prefix, series, law.pressure), 3);
  law.pressure = {P.solution.x(0), P.solution.x(1), P.solution.x(2)};
  for (std::size_t i = 0; i < fits.size() && options.profiles; ++i)
    profile_doubtful(problems[i].parameters, problems[i].blocks, options.threads, control, fits[i]);
  return fits;
}

StageFit fit_overlap(const std::vector<DensitySeries>& series, const std::string& window, const StageFit& pressure,
                     double start, const CalibrationOptions& options, const RunControl& control) {
  const double nu_c = pressure.solution.x(2);
  for (const DensitySeries& s : series) {
    if (std::any_of(s.points.begin(), s.points.end(),
                    [](const DensityPoint& p) { return std::isnan(p.mean_overlap); })) {
      return skipped_stage("overlap", {"overlap.D"},
                           "test " + s.test + " lacks values of mean_overlap; add the column");
    }
  }
  const auto blocks = blocks_of<Jet1>(
      series, "mean_overlap", 1,
      [nu_c](const DensityPoint& p, const auto* x) { return x[0] * std::log(p.nu / nu_c) - p.mean_overlap; },
      [](const DensityPoint& p) { return p.mean_overlap; });
  StageFit fit =
      fit_stage("overlap", window + fmt::format(", rows unweighted, nu_c = {:.5f} of the pressure", nu_c),
                {free_parameter("overlap.D", start)}, blocks, kMoreDensities, options.threads, control, {options.loss});
  const double D = fit.solution.x(0);
  inherit_nu_c(pressure, slope_of(series, [&](const DensityPoint&) { return -D / nu_c; }), fit);
  return fit;
}

StageFit fit_fabric_trace(const std::vector<DensitySeries>& series, const std::string& window, double start,
                          const CalibrationOptions& options, const RunControl& control) {
  const auto blocks = blocks_of<Jet1>(
      series, "F_v", 1, [](const DensityPoint& p, const auto* x) { return x[0] * (p.nu * p.C()) - p.F_v; },
      [](const DensityPoint& p) { return p.F_v; });
  return fit_stage("fabric_trace", window + ", rows unweighted, measured C", {free_parameter("fabric.g3", start)},
                   blocks, kMoreDensities, options.threads, control, {options.loss});
}

}  // namespace grainlaw::fit
