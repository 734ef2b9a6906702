#include "fit/stages/evolution_blocks.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "fit/stages/trajectory_misfit.hpp"

namespace grainlaw::fit {
namespace {

constexpr int kMostParameters = 16;
using Jet = ceres::Jet<double, kMostParameters>;

std::string quantity_name(char symbol, std::size_t axis) {
  return axis == 0 ? std::string(1, symbol) + "_par" : std::string(1, symbol) + "_axis" + std::to_string(axis + 1);
}

ResidualBlock evolution_block(const Trajectory& t, const LawParameters<double>& fixed,
                              const std::vector<std::size_t>& index, const CalibrationOptions& options) {
  const auto rows = static_cast<Eigen::Index>(t.rows.size());
  const auto axes = static_cast<Eigen::Index>(t.axes.size());
  ResidualBlock block;
  block.test = t.test;
  block.cluster = t.cluster;
  block.weight = Eigen::VectorXd::Zero(rows * (1 + 2 * axes));
  const auto add = [&](const std::string& quantity, Eigen::Index first, auto datum, auto weight) {
    Channel channel{quantity, static_cast<int>(first), static_cast<int>(rows), t.excluded, 0};
    for (Eigen::Index i = 0; i < rows; ++i) {
      const TrajectoryRow& row = t.rows[static_cast<std::size_t>(i)];
      channel.max_abs_data = std::max(channel.max_abs_data, std::abs(datum(row.data)));
      block.weight(first + i) = weight(row);
    }
    block.channels.push_back(channel);
  };
  add(
      "P_star", 0, [](const LawState<double>& y) { return y.P; },
      [&](const TrajectoryRow& row) {
        return t.starts_on_law ? row.weight / (options.pressure_scale * row.data.P) : 0.0;
      });
  for (Eigen::Index a = 0; a < axes; ++a) {
    const Deviator<double>& n = t.axes[static_cast<std::size_t>(a)];
    add(
        quantity_name('s', static_cast<std::size_t>(a)), rows * (1 + a),
        [&](const LawState<double>& y) { return y.sigma.dot(n) / y.P; },
        [&](const TrajectoryRow& row) { return row.weight / options.stress_scale; });
    add(
        quantity_name('F', static_cast<std::size_t>(a)), rows * (1 + axes + a),
        [&](const LawState<double>& y) { return y.F.dot(n); },
        [&](const TrajectoryRow& row) { return row.weight / options.fabric_scale; });
  }
  block.evaluate = differentiated<Jet>(
      TrajectoryMisfit{t, fixed, index, Rung::evolution, options.coupling, options.max_step, t.axes.size()},
      static_cast<int>(index.size()), block.rows());
  return block;
}

}  // namespace

std::vector<ResidualBlock> evolution_blocks(const std::vector<Trajectory>& trajectories,
                                            const LawParameters<double>& law, const std::vector<std::string>& free,
                                            const CalibrationOptions& options) {
  std::vector<std::size_t> index;
  for (const std::string& name : free) index.push_back(parameter_index(name));
  std::vector<ResidualBlock> blocks;
  for (const Trajectory& t : trajectories) blocks.push_back(evolution_block(t, law, index, options));
  return blocks;
}

}  // namespace grainlaw::fit
