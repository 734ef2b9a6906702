#include "fit/statistics/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "fit/statistics/huber_loss.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kSameCost = 1e-6;    // relative difference of two solutions that are one
constexpr double kExactCost = 1e-16;  // of the cost at the start: a solution that meets the data exactly
constexpr double kDensityRange = 0.005;

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
