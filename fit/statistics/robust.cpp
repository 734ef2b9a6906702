#include "fit/statistics/robust.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace grainlaw::fit {
namespace {

constexpr double kHuber = 1.345;
constexpr double kNormalMedian = 1.4826;  // standard deviation over median magnitude of normal noise
constexpr double kSettledFactor = 1e-3;   // largest change of a factor at the end
constexpr double kExactMisfit = 1e-9;     // of the data: below, misfits are rounding and no row stands out
constexpr int kRounds = 30;

double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Factors of all rows, for misfits `r` of blocks with their own weights.
Eigen::VectorXd factors_of(const std::vector<ResidualBlock>& blocks, const Eigen::VectorXd& r) {
  std::map<std::string, std::vector<double>> off;
  std::map<std::string, double> least;
  const auto each_row = [&](const auto& visit) {
    Eigen::Index first = 0;
    for (const ResidualBlock& block : blocks) {
      for (const Channel& channel : block.channels) {
        for (Eigen::Index i = channel.first; i < channel.first + channel.rows; ++i) {
          if (block.weight(i) > 0) visit(channel, first + i, std::abs(block.weight(i) * r(first + i)), block.weight(i));
        }
      }
      first += block.rows();
    }
  };
  each_row([&](const Channel& channel, Eigen::Index, double distance, double weight) {
    off[channel.quantity].push_back(distance);
    double& floor = least[channel.quantity];
    floor = std::max(floor, kExactMisfit * weight * channel.max_abs_data);
  });
  std::map<std::string, double> reach;
  for (const auto& [quantity, values] : off)
    reach[quantity] = kHuber * std::max(kNormalMedian * upper_median(values), least[quantity]);
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(r.size());
  each_row([&](const Channel& channel, Eigen::Index row, double distance, double) {
    if (distance > reach[channel.quantity]) factor(row) = std::sqrt(reach[channel.quantity] / distance);
  });
  return factor;
}

}  // namespace

Solution solve_huber(const std::vector<FreeParameter>& parameters, const std::vector<ResidualBlock>& blocks,
                     int threads, const std::string& stage, const RunControl& control) {
  std::vector<ResidualBlock> weighted = blocks;
  std::vector<FreeParameter> from = parameters;
  Solution solution = solve(from, weighted, threads, stage, control);
  const double initial_cost = solution.initial_cost;
  int iterations = solution.iterations;
  double seconds = solution.seconds;
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(solution.weight.size());
  for (int round = 0; round < kRounds && solution.defined; ++round) {
    const Eigen::VectorXd next = factors_of(blocks, solution.misfit);
    const double change = next.size() > 0 ? (next - factor).cwiseAbs().maxCoeff() : 0;
    if (change < kSettledFactor) break;
    factor = next;
    Eigen::Index first = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      weighted[b].weight = blocks[b].weight.cwiseProduct(factor.segment(first, blocks[b].rows()));
      first += blocks[b].rows();
    }
    for (std::size_t k = 0; k < from.size(); ++k) from[k].start = solution.x(static_cast<Eigen::Index>(k));
    solution = solve(from, weighted, threads, stage, control);
    iterations += solution.iterations;
    seconds += solution.seconds;
    if (round + 1 == kRounds) {
      solution.converged = false;
      solution.termination += fmt::format(" (weights of Huber's loss still change by {:.2g})", change);
    }
  }
  solution.pull_slope = (factor.array() < 1).select(Eigen::VectorXd::Zero(factor.size()), solution.pull_slope);
  solution.initial_cost = initial_cost;
  solution.iterations = iterations;
  solution.seconds = seconds;
  return solution;
}

}  // namespace grainlaw::fit
