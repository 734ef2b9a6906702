#include "fit/statistics/huber_loss.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "fit/statistics/covariance.hpp"

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

/// Of all rows, for misfits `r` of blocks with their own weights: the weighted misfit beyond which the loss holds the pull, by the
/// rows of all packings but `without`. Infinite where there are none.
Eigen::VectorXd reach_of(const std::vector<ResidualBlock>& blocks, const Eigen::VectorXd& r, int without = -1) {
  std::map<std::string, std::vector<double>> off;
  std::map<std::string, double> least;
  const auto each_row = [&](const auto& visit) {
    Eigen::Index first = 0;
    for (const ResidualBlock& block : blocks) {
      for (const Channel& channel : block.channels) {
        for (Eigen::Index i = channel.first; i < channel.first + channel.rows; ++i) {
          if (block.weight(i) > 0) visit(block, channel, i, first + i);
        }
      }
      first += block.rows();
    }
  };
  each_row([&](const ResidualBlock& block, const Channel& channel, Eigen::Index i, Eigen::Index row) {
    if (block.cluster == without) return;
    off[channel.quantity].push_back(std::abs(block.weight(i) * r(row)));
    double& floor = least[channel.quantity];
    floor = std::max(floor, kExactMisfit * block.weight(i) * channel.max_abs_data);
  });
  std::map<std::string, double> of;
  for (const auto& [quantity, values] : off)
    of[quantity] = kHuber * std::max(kNormalMedian * upper_median(values), least[quantity]);
  Eigen::VectorXd reach = Eigen::VectorXd::Constant(r.size(), std::numeric_limits<double>::infinity());
  each_row([&](const ResidualBlock&, const Channel& channel, Eigen::Index, Eigen::Index row) {
    if (const auto at = of.find(channel.quantity); at != of.end()) reach(row) = at->second;
  });
  return reach;
}

/// A row as its own weight has it, and its pull on average over where the scatter of the fit moves it.
struct ScatteredRow {
  double factor = 1;  ///< of the weight
  double free = 1;    ///< d pull/d misfit
  double held = 0;    ///< d pull/d reach, with the sign of the misfit
};

ScatteredRow scattered(const Solution& solution, const Eigen::MatrixXd& influence, Eigen::Index i) {
  ScatteredRow row;
  const double reach = solution.reach(i), lightened = solution.weight(i) * solution.misfit(i);
  if (std::isinf(reach)) return row;
  row.factor = std::min(1.0, reach / std::abs(lightened));
  const double off = lightened / row.factor;
  const double scatter = solution.weight(i) / row.factor * (solution.jacobian.row(i) * influence).norm();
  const auto below = [&](double x) {
    return scatter > 0 ? std::erfc(-x / (std::sqrt(2.) * scatter)) / 2 : x >= 0 ? 1. : 0.;
  };
  row.free = below(reach - off) - below(-reach - off);
  row.held = below(off - reach) - below(-reach - off);
  return row;
}

}  // namespace

Solution solve_huber(const Problem& problem, int threads, const std::string& stage, const RunControl& control) {
  const std::vector<ResidualBlock>& blocks = problem.blocks;
  Problem weighted = problem;
  Solution solution = solve(weighted, threads, stage, control);
  const double initial_cost = solution.initial_cost;
  int iterations = solution.iterations;
  double seconds = solution.seconds;
  const Eigen::VectorXd own_weight = solution.weight;
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(own_weight.size()), reach = solution.reach;
  for (int round = 0; round < kRounds && solution.defined; ++round) {
    reach = reach_of(blocks, solution.misfit);
    const Eigen::ArrayXd off = own_weight.cwiseProduct(solution.misfit).cwiseAbs();
    const Eigen::VectorXd next = (off > reach.array()).select((reach.array() / off).sqrt(), 1);
    const double change = next.size() > 0 ? (next - factor).cwiseAbs().maxCoeff() : 0;
    if (change < kSettledFactor) break;
    factor = next;
    Eigen::Index first = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      weighted.blocks[b].weight = blocks[b].weight.cwiseProduct(factor.segment(first, blocks[b].rows()));
      first += blocks[b].rows();
    }
    for (std::size_t k = 0; k < weighted.parameters.size(); ++k)
      weighted.parameters[k].start = solution.x(static_cast<Eigen::Index>(k));
    solution = solve(weighted, threads, stage, control);
    iterations += solution.iterations;
    seconds += solution.seconds;
    if (round + 1 == kRounds) {
      solution.converged = false;
      solution.termination += fmt::format(" (weights of Huber's loss still change by {:.2g})", change);
    }
  }
  solution.reach = reach;
  solution.initial_cost = initial_cost;
  solution.iterations = iterations;
  solution.seconds = seconds;
  return solution;
}

Eigen::VectorXd pull_slopes(const Solution& solution, const Eigen::MatrixXd& influence) {
  Eigen::VectorXd slope(solution.weight.size());
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    const ScatteredRow row = scattered(solution, influence, i);
    slope(i) = row.free / (row.factor * row.factor);
  }
  return slope;
}

Eigen::MatrixXd influence_of_reach(const std::vector<ResidualBlock>& blocks, const Solution& solution,
                                   const Eigen::MatrixXd& influence) {
  const Eigen::Index rows = solution.weight.size(), packings = influence.cols();
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(rows, packings);  // reach, by the grouped jackknife
  std::set<int> present;
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (solution.weight(i) > 0) present.insert(solution.cluster[static_cast<std::size_t>(i)]);
  }
  if (present.size() > 1) {
    for (const int c : present) {
      const Eigen::VectorXd without = reach_of(blocks, solution.misfit, c);
      moved.col(c) = without.array().isFinite().select(without - solution.reach, 0);
    }
    const double n = static_cast<double>(present.size());
    const Eigen::VectorXd mean = moved.rowwise().sum() / n;
    for (const int c : present) moved.col(c) = -std::sqrt((n - 1) / n) * (moved.col(c) - mean);
  }
  Eigen::VectorXd pull(rows);  // d pull/d reach
  for (Eigen::Index i = 0; i < rows; ++i) {
    const ScatteredRow row = scattered(solution, influence, i);
    pull(i) = solution.weight(i) / row.factor * row.held;
  }
  std::vector<bool> free(solution.at_bound);
  free.flip();
  Eigen::MatrixXd added = response(solution.weight.asDiagonal() * solution.jacobian, free,
                                   solution.jacobian.transpose() * pull.asDiagonal() * moved, solution.curvature);
  for (Eigen::Index k = 0; k < added.rows(); ++k) {
    if (influence.row(k).isZero(0)) added.row(k).setZero();
  }
  return added;
}

}  // namespace grainlaw::fit
