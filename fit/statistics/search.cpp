#include "fit/statistics/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>

namespace grainlaw::fit {
namespace {

constexpr double kHuber = 1.345;
constexpr double kNormalMedian = 1.4826;  // standard deviation over median magnitude of normal noise
constexpr double kSettledFactor = 1e-3;   // largest change of a factor at the end
constexpr double kExactMisfit = 1e-9;     // of the data: below, misfits are rounding and no row stands out
constexpr int kRounds = 30;

constexpr double kSameCost = 1e-6;    // relative difference of two solutions that are one
constexpr double kExactCost = 1e-16;  // of the cost at the start: a solution that meets the data exactly
constexpr double kDensityRange = 0.005;

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

/// The converged solution of lowest cost, the first one when none is.
Solution best_of(std::vector<Solution> solutions, StartSearch& search) {
  double rounding = 0;
  for (const Solution& solution : solutions) rounding = std::max(rounding, kExactCost * solution.initial_cost);
  const auto within = [&](double cost, double least) { return cost <= least * (1 + kSameCost) + rounding; };
  std::size_t best = 0;
  for (std::size_t i = 1; i < solutions.size(); ++i) {
    const Solution &a = solutions[i], &b = solutions[best];
    if (a.converged && (!b.converged || !within(b.final_cost, a.final_cost))) best = i;
  }
  search = {static_cast<int>(solutions.size()), 0, std::nan("")};
  for (const Solution& solution : solutions) {
    if (!solution.converged) continue;
    if (within(solution.final_cost, solutions[best].final_cost))
      ++search.at_minimum;
    else if (!(solution.final_cost >= search.next_cost))
      search.next_cost = solution.final_cost;
  }
  double seconds = 0;
  for (const Solution& solution : solutions) seconds += solution.seconds;
  solutions[best].seconds = seconds;
  return std::move(solutions[best]);
}

}  // namespace

Solution solve_huber(const Problem& problem, int threads, const std::string& stage, const RunControl& control) {
  const std::vector<ResidualBlock>& blocks = problem.blocks;
  Problem weighted = problem;
  Solution solution = solve(weighted, threads, stage, control);
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
  solution.pull_slope = (factor.array() < 1).select(Eigen::VectorXd::Zero(factor.size()), solution.pull_slope);
  solution.initial_cost = initial_cost;
  solution.iterations = iterations;
  solution.seconds = seconds;
  return solution;
}

std::vector<FreeParameter> start_number(const std::vector<FreeParameter>& from, int which) {
  std::vector<FreeParameter> parameters = from;
  if (which == 0) return parameters;
  std::mt19937_64 engine(static_cast<std::uint64_t>(which));
  const auto within_one = [&] { return 2 * (static_cast<double>(engine() >> 11) * 0x1p-53) - 1; };
  for (FreeParameter& p : parameters) {
    const double u = within_one();
    if (p.name.ends_with(".nu_c"))
      p.start += kDensityRange * u;
    else if (p.start == 0)
      p.start = p.scale / 3 * u;
    else
      p.start *= std::exp(std::log(3.0) * u);
    p.start = std::clamp(p.start, p.lower, p.upper);
  }
  return parameters;
}

Solution minimise(const Problem& problem, int starts, int threads, const std::string& stage, const RunControl& control,
                  StartSearch& search) {
  Problem from = problem;
  std::vector<Solution> solutions;
  for (int i = 0; i < starts; ++i) {
    from.parameters = start_number(problem.parameters, i);
    solutions.push_back(from.loss == Loss::huber ? solve_huber(from, threads, stage, control)
                                                 : solve(from, threads, stage, control));
  }
  return best_of(std::move(solutions), search);
}

}  // namespace grainlaw::fit
