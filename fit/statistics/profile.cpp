#include "fit/statistics/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fit/statistics/covariance.hpp"
#include "model/student.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kAtTheEnd = 0.02;  // relative distance from which the rest is a straight line
constexpr int kExpansions = 8, kRefinements = 14;
constexpr SolverEffort kRefit{2, 4};  // from a neighbour's solution

/// The blocks as functions of all parameters but `k`, which is held at `value`.
std::vector<ResidualBlock> holding(const std::vector<ResidualBlock>& blocks, std::size_t n, std::size_t k,
                                   double value) {
  std::vector<ResidualBlock> held;
  for (const ResidualBlock& block : blocks) {
    ResidualBlock part{block.test, block.cluster, block.channels, block.weight, {}};
    part.evaluate = [&block, n, k, value](const double* x, double* misfit, double* jacobian) {
      std::vector<double> all(x, x + n - 1);
      all.insert(all.begin() + static_cast<std::ptrdiff_t>(k), value);
      if (jacobian == nullptr) return block.evaluate(all.data(), misfit, nullptr);
      const auto rows = static_cast<std::size_t>(block.rows());
      std::vector<double> whole(rows * n);
      if (!block.evaluate(all.data(), misfit, whole.data())) return false;
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
          if (j != k) jacobian[i * (n - 1) + j - (j > k ? 1 : 0)] = whole[i * n + j];
        }
      }
      return true;
    };
    held.push_back(std::move(part));
  }
  return held;
}

/// The cost as a function of one parameter, the others fitted again from where they were last.
class ProfiledCost {
 public:
  ProfiledCost(const Problem& problem, const StageFit& fit, std::size_t k, int threads, const RunControl& control)
      : blocks_(problem.blocks),
        k_(k),
        n_(problem.parameters.size()),
        threads_(threads),
        control_(control),
        others_(problem.parameters),
        name_(problem.parameters[k].name) {
    for (std::size_t j = 0; j < n_; ++j) others_[j].start = fit.solution.x(static_cast<Eigen::Index>(j));
    others_.erase(others_.begin() + static_cast<std::ptrdiff_t>(k));
  }

  /// NaN where the model is not defined.
  double operator()(double value) {
    const Solution solution =
        solve({others_, holding(blocks_, n_, k_, value)}, threads_, "profile of " + name_, control_, kRefit);
    if (!solution.defined) return kUndefined;
    for (std::size_t j = 0; j < others_.size(); ++j) others_[j].start = solution.x(static_cast<Eigen::Index>(j));
    return solution.final_cost;
  }

 private:
  const std::vector<ResidualBlock>& blocks_;
  std::size_t k_, n_;
  int threads_;
  const RunControl& control_;
  std::vector<FreeParameter> others_;
  std::string name_;
};

/// V_kk/(A^+)_kk of a parameter, and what the stage's parameters have on average.
struct Inflation {
  Eigen::VectorXd own;  // NaN without an error
  double mean = kUndefined;
  double degrees_of_freedom = kUndefined;  // the smallest of the stage
};

Inflation inflation_of(const StageFit& fit) {
  const Solution& s = fit.solution;
  std::vector<bool> free(s.at_bound);
  free.flip();
  const Eigen::VectorXd naive = naive_variance(s.weight.asDiagonal() * s.jacobian, free, s.curvature);
  Inflation inflation{Eigen::VectorXd::Constant(naive.size(), kUndefined), kUndefined, kUndefined};
  double sum = 0;
  int count = 0;
  for (Eigen::Index k = 0; k < naive.size(); ++k) {
    const Estimate& e = fit.stage.estimates[static_cast<std::size_t>(k)].estimate;
    if (!std::isfinite(e.standard_error) || !(naive(k) > 0)) continue;
    inflation.own(k) = e.standard_error * e.standard_error / naive(k);
    sum += inflation.own(k);
    ++count;
    if (!(inflation.degrees_of_freedom <= e.degrees_of_freedom)) inflation.degrees_of_freedom = e.degrees_of_freedom;
  }
  if (count > 0) inflation.mean = sum / count;
  return inflation;
}

/// Goes from the minimum towards `bound` until D exceeds t^2; NaN when it does not before the bound.
double end_of(ProfiledCost cost, const FreeParameter& p, double best, double step, double bound, double minimum,
              double unit, std::vector<ProfilePoint>& points) {
  // sqrt(D)/t is linear where the cost is a parabola: one at the end of the interval.
  const auto distance = [&](double value) {
    const double more = cost(value) - minimum, excess = std::isnan(more) ? more : std::max(0.0, more) / unit;
    points.push_back({value, excess});
    return std::sqrt(excess);
  };
  const double sign = bound > best ? 1 : -1;
  double inside = best, at_inside = 0, outside = kUndefined, at_outside = kUndefined;
  for (int expansion = 0; expansion < kExpansions && std::isnan(outside); ++expansion) {
    double next = inside + sign * step;
    const bool last = sign * (bound - next) <= 1e-9 * p.scale;
    if (last) next = bound;
    const double s = distance(next);
    if (std::isnan(s)) return kUndefined;
    if (s >= 1) {
      outside = next;
      at_outside = s;
    } else {
      if (last) return kUndefined;
      step = std::abs(next - best) * std::clamp(1.2 / std::max(s, 1e-3) - 1, 0.5, 3.0);
      inside = next;
      at_inside = s;
    }
  }
  if (std::isnan(outside)) return kUndefined;
  const auto between = [&] { return inside + (outside - inside) * (1 - at_inside) / (at_outside - at_inside); };
  for (int i = 0; i < kRefinements && at_outside - at_inside > 0.05; ++i) {
    const double middle = i % 2 == 0 ? between() : (inside + outside) / 2, s = distance(middle);
    if (std::isnan(s)) break;
    if (std::abs(s - 1) < kAtTheEnd) return middle + (middle - best) * (1 - s) / s;
    (s < 1 ? inside : outside) = middle;
    (s < 1 ? at_inside : at_outside) = s;
  }
  return between();
}

/// The kind of test whose repetition on another packing would lower the parameter's variance most, and to which part:
/// H -> H + J_t^T J_t, rows as independent as they are now.
std::string most_telling_test(const std::vector<ResidualBlock>& blocks, const Solution& solution, std::size_t k) {
  std::vector<bool> free(solution.at_bound);
  free.flip();
  free[k] = true;
  const Eigen::MatrixXd J = solution.weight.asDiagonal() * solution.jacobian;
  std::map<std::string, std::vector<Eigen::Index>> rows_of;
  Eigen::Index first = 0;
  for (const ResidualBlock& block : blocks) {
    std::vector<Eigen::Index>& rows = rows_of[block.test];
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      if (block.weight(i) > 0) rows.push_back(first + i);
    }
    first += block.rows();
  }
  const auto index = static_cast<Eigen::Index>(k);
  const double now = naive_variance(J, free)(index);
  std::string best;
  double least = now;
  for (const auto& [test, rows] : rows_of) {
    Eigen::MatrixXd more(J.rows() + static_cast<Eigen::Index>(rows.size()), J.cols());
    more << J, J(rows, Eigen::all);
    const double then = naive_variance(more, free)(index);
    if (then < least) {
      least = then;
      best = test;
    }
  }
  if (best.empty() || !(now > 0)) return "";
  return fmt::format("of the tests there are, a repetition of {} on another packing would narrow it most, to {:.0f} %",
                     best, 100 * std::sqrt(least / now));
}

}  // namespace

std::string doubt(const Estimate& estimate) {
  if (estimate.status == Status::at_bound) return "at its bound";
  if (estimate.status == Status::not_identified) return "not identified";
  if (estimate.status == Status::fitted && estimate.half_width() >= std::abs(estimate.value))
    return "its interval contains zero";
  return "";
}

void profile_doubtful(const Problem& problem, int threads, const RunControl& control, StageFit& fit) {
  const std::vector<FreeParameter>& parameters = problem.parameters;
  const Solution& solution = fit.solution;
  if (!solution.defined || parameters.size() < 2 || problem.loss == Loss::huber) return;
  const Inflation inflation = inflation_of(fit);
  if (std::isnan(inflation.mean)) return;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const FreeParameter& p = parameters[k];
    const Estimate& estimate = fit.stage.estimates[k].estimate;
    const auto i = static_cast<Eigen::Index>(k);
    Profile profile{p.name, doubt(estimate), kUndefined, kUndefined, {}, ""};
    if (profile.reason.empty()) continue;
    const double half = estimate.half_width(), best = solution.x(i);
    const double t = student_95(std::isnan(half) ? inflation.degrees_of_freedom : estimate.degrees_of_freedom);
    const double unit = t * t * (std::isnan(half) ? inflation.mean : inflation.own(i)) / 2;  // of the cost, D = t^2
    const double step = std::isnan(half) ? p.scale / 2 : half;
    const ProfiledCost cost(problem, fit, k, threads, control);
    profile.points.push_back({best, 0});
    if (best > p.lower) profile.lower = end_of(cost, p, best, step, p.lower, solution.final_cost, unit, profile.points);
    if (best < p.upper) profile.upper = end_of(cost, p, best, step, p.upper, solution.final_cost, unit, profile.points);
    std::ranges::sort(profile.points, {}, &ProfilePoint::value);
    profile.experiment = estimate.note;
    if (estimate.status != Status::not_identified) profile.experiment = most_telling_test(problem.blocks, solution, k);
    fit.stage.profiles.push_back(profile);
  }
}

}  // namespace grainlaw::fit
