#include "fit/stages/memory_fit.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/stages/evolution_fit.hpp"
#include "fit/statistics/profile.hpp"
#include "fit/stages/trajectory_misfit.hpp"

namespace grainlaw::fit {
namespace {

constexpr int kMemoryParameters = 8;
using MemoryJet = ceres::Jet<double, kMemoryParameters>;
constexpr double kVagueParameter = 0.5;  // relative error beyond which a parameter is no number
constexpr double kWindowRounding = 1e-9;
const std::vector<std::string> kGivenToMemory{"coordination",        "rattlers",        "pressure",
                                              "steady_coordination", "steady_rattlers", "steady_pressure",
                                              "stress_ratio_max",    "fabric_max"};

std::vector<std::string> free_names(bool volumetric) {
  std::vector<std::string> names{"memory.G", "memory.alpha", "memory.k", "memory.lambda", "memory.chi", "memory.kappa"};
  if (volumetric) names.insert(names.end(), {"memory.c_F", "memory.a2"});
  return names;
}

bool constant_volume(const Trajectory& t) { return std::abs(t.direction.dx) <= 1e-12; }

/// Rows of a channel that count.
struct Counted {
  double window;        ///< deviatoric strain up to which they do; together they weigh 1/scale
  bool beyond = false;  ///< the others, too; together they weigh as much
};

/// Mean P* of the rows. Weights by each row's own P* would be larger where its noise makes it small, and the law too low.
double mean_pressure(const Trajectory& t) {
  double sum = 0;
  for (const TrajectoryRow& row : t.rows) sum += row.data.P;
  return sum / static_cast<double>(t.rows.size());
}

/// Adds a quantity as one channel.
void add_channel(const Trajectory& t, const std::string& quantity, Counted counted, ResidualBlock& block,
                 double (*datum)(const Trajectory&, const LawState<double>&), double scale) {
  const int rows = static_cast<int>(t.rows.size()), first = rows * static_cast<int>(block.channels.size());
  const auto in = [&](const TrajectoryRow& row) { return t.direction.de * row.e <= counted.window + kWindowRounding; };
  const auto inside = std::count_if(t.rows.begin(), t.rows.end(), in), outside = rows - inside;
  Channel channel{quantity, first, rows, t.excluded, 0};
  for (int i = 0; i < rows; ++i) {
    const TrajectoryRow& row = t.rows[static_cast<std::size_t>(i)];
    channel.max_abs_data = std::max(channel.max_abs_data, std::abs(datum(t, row.data)));
    if (in(row) || counted.beyond)
      block.weight(first + i) = 1 / (std::sqrt(static_cast<double>(in(row) ? inside : outside)) * scale);
  }
  block.channels.push_back(channel);
}

ResidualBlock memory_block(const Trajectory& t, const LawParameters<double>& fixed,
                           const std::vector<std::size_t>& index, const CalibrationOptions& options) {
  constexpr Counted all{1e300}, none{-1};
  const bool shear = constant_volume(t);
  ResidualBlock block;
  block.test = t.test;
  block.cluster = t.cluster;
  block.weight = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(t.rows.size()));
  add_channel(
      t, "P_star", shear ? all : none, block, [](const Trajectory&, const LawState<double>& y) { return y.P; },
      options.pressure_scale * mean_pressure(t));
  add_channel(
      t, "s_par", shear ? Counted{options.stiffness_window, true} : all, block,
      [](const Trajectory& of, const LawState<double>& y) { return y.sigma.dot(of.axes.front()) / y.P; },
      options.stress_scale);
  add_channel(
      t, "F_par", shear ? Counted{options.lag_window} : all, block,
      [](const Trajectory& of, const LawState<double>& y) { return y.F.dot(of.axes.front()); }, options.fabric_scale);
  block.evaluate =
      differentiated<MemoryJet>(TrajectoryMisfit{t, fixed, index, Rung::memory, Coupling::energy, options.max_step, 1},
                                static_cast<int>(index.size()), block.rows());
  return block;
}

/// Whether none of the fabric may lag, kappa being on its bound or within its 95 % interval of it: then the rate lambda at which it
/// follows need not be known.
bool lag_may_be_none(const StageFit& fit) {
  for (const auto& [name, kappa] : fit.stage.estimates) {
    if (name == "memory.kappa")
      return !(kappa.value + kappa.half_width() < parameter_table()[parameter_index(name)].upper);
  }
  return false;
}

std::string memory_window(const CalibrationOptions& options) {
  return fmt::format(
      "all trajectories with shear, each segment from its measured start: at constant volume P* of all rows relative "
      "to the mean, scale {:g}, s_par of eps_dev <= {:g} and with the same weight of the rest, scale {:g}, F_par of "
      "eps_dev <= {:g}, scale {:g}; where the volume changes s_par and F_par of all rows",
      options.pressure_scale, options.stiffness_window, options.stress_scale, options.lag_window, options.fabric_scale);
}

}  // namespace

MemoryProblem memory_problem(const std::vector<Trajectory>& trajectories, const LawParameters<double>& start,
                             bool volumetric, const CalibrationOptions& options) {
  MemoryProblem problem;
  std::vector<std::size_t> index;
  const auto value = fields(start);
  for (const std::string& name : free_names(volumetric)) {
    index.push_back(parameter_index(name));
    problem.parameters.push_back(free_parameter(name, *value[index.back()]));
  }
  for (const Trajectory& t : trajectories) {
    if (!t.axes.empty() && !t.rows.empty()) problem.blocks.push_back(memory_block(t, start, index, options));
  }
  return problem;
}

StageFit fit_memory(const std::vector<Trajectory>& trajectories, LawParameters<double>& law,
                    const CalibrationOptions& options, const RunControl& control, const FoundErrors& found) {
  const std::string remedy =
      "add a test that shears and then changes the volume, e.g. D2 to eps_dev = 0.15 and then ISO to nu + 0.03 and "
      "back";
  const bool volumetric = contains_anisotropy(trajectories);
  const MemoryProblem problem = memory_problem(trajectories, law, volumetric, options);
  StageFit fit = fit_stage("memory", memory_window(options), problem.parameters, problem.blocks,
                           "the trajectories do not determine it; shear at more and at lower densities",
                           options.threads, control, {options.loss, options.starts});
  if (fit.solution.defined) {
    inherit_error(
        kGivenToMemory, found, law,
        [&](const LawParameters<double>& given) {
          return memory_problem(trajectories, given, volumetric, options).blocks;
        },
        options.threads, fit);
    const auto field = fields(law);
    const bool may_not_lag = lag_may_be_none(fit);
    for (std::size_t k = 0; k < problem.parameters.size(); ++k) {
      const std::string& name = problem.parameters[k].name;
      const double value = fit.solution.x(static_cast<Eigen::Index>(k));
      *field[parameter_index(name)] = value;
      const double error = fit.stage.estimates[k].estimate.standard_error;
      const bool may_be_vague = name == "memory.chi" || name == "memory.kappa" ||  // both may be none
                                (name == "memory.lambda" && may_not_lag);
      if (!may_be_vague && error > kVagueParameter * std::abs(value))
        fit.mark_not_identified(
            name, fmt::format("its error is {:.2g} of its value; ", error / std::abs(value)) +
                      (name == "memory.c_F" || name == "memory.a2" ? remedy : "add seeds and lower densities"));
    }
  }
  if (options.profiles) profile_doubtful(problem.parameters, problem.blocks, options.threads, control, fit);
  if (!volumetric) {
    for (const char* name : {"memory.c_F", "memory.a2"})
      fit.stage.estimates.push_back({name, {0, std::nan(""), Status::not_identified, remedy}});
  }
  return fit;
}

StageFit no_memory(const std::string& remedy) { return skipped_stage("memory", free_names(true), remedy); }

}  // namespace grainlaw::fit
