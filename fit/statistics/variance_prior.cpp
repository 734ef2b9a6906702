#include "fit/statistics/variance_prior.hpp"

#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>
#include <cmath>
#include <limits>
#include <map>

namespace grainlaw::fit {
namespace {

constexpr double kOtherMaterial =
    4;                           // ratio of variances, besides chance, from which on the prior is another material's
constexpr double kChance = 3.3;  // standard deviations that chance may do: one in a thousand
constexpr double kFew = 0.6;     // of the packings
constexpr std::size_t kLeastParts = 8;  // from which a parameter's d0 is told

bool has_error(const CalibratedLaw& law, std::size_t i) {
  const Estimate& e = law.estimates[i];
  return e.standard_error > 0 && std::isfinite(e.degrees_of_freedom);
}

bool has_error(const VariancePrior& prior, std::size_t i) {
  const auto k = static_cast<Eigen::Index>(i);
  return prior.covariance(k, k) > 0 && std::isfinite(prior.degrees_of_freedom(k));
}

double variance(const CalibratedLaw& law, std::size_t i) {
  return law.estimates[i].standard_error * law.estimates[i].standard_error;
}

/// E ln(chi^2_d/d) and the variance of it.
double mean_log(double d) { return boost::math::digamma(d / 2) - std::log(d / 2); }
double variance_of_log(double d) { return boost::math::trigamma(d / 2); }

/// d with psi'(d/2) = `excess`, within .1 ... `most`.
double degrees_from_excess(double excess, double most) {
  if (excess <= variance_of_log(most)) return most;
  double low = 0.1, high = most;
  if (excess >= variance_of_log(low)) return low;
  while (high - low > 1e-6 * high) {
    const double middle = (low + high) / 2;
    (variance_of_log(middle) > excess ? low : high) = middle;
  }
  return low;
}

/// Parameters that both know, in groups of which both know the same.
std::vector<std::size_t> common_parameters(const VariancePrior& prior, const CalibratedLaw& law) {
  std::map<std::string, bool> same;
  const auto group = [](std::size_t i) {
    const std::string name = parameter_table()[i].name;
    return name.substr(0, name.find('.'));
  };
  for (std::size_t i = 0; i < kParameterCount; ++i)
    same.try_emplace(group(i), true).first->second &= has_error(prior, i) == has_error(law, i);
  std::vector<std::size_t> common;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    if (has_error(prior, i) && same[group(i)]) common.push_back(i);
  }
  return common;
}

}  // namespace

VariancePrior variance_prior(const SizedLaw& many, const std::vector<SizedLaw>& parts) {
  VariancePrior prior{
      many.size, many.law.covariance,
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(kParameterCount), std::numeric_limits<double>::quiet_NaN())};
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    double weights = 0, excess = 0;
    std::size_t seen = 0;
    for (const SizedLaw& part : parts) {
      if (!has_error(many.law, i) || !has_error(part.law, i)) continue;
      const double d = part.law.estimates[i].degrees_of_freedom;
      const double s0 = variance(many.law, i) * many.size.spheres / part.size.spheres;
      const double z = std::log(variance(part.law, i) / s0) - mean_log(d);
      const double weight = 1 / (variance_of_log(d) * variance_of_log(d));
      weights += weight;
      excess += weight * (z * z - variance_of_log(d));
      ++seen;
    }
    if (seen >= kLeastParts)
      prior.degrees_of_freedom(k) = degrees_from_excess(excess / weights, many.law.estimates[i].degrees_of_freedom);
  }
  for (Eigen::Index k = 0; k < prior.covariance.rows(); ++k) {
    if (std::isfinite(prior.degrees_of_freedom(k))) continue;
    prior.covariance.row(k).setZero();
    prior.covariance.col(k).setZero();
  }
  return prior;
}

Moderation moderate(const VariancePrior& prior, const PackingCount& size, CalibratedLaw& law) {
  Moderation done;
  const std::vector<std::size_t> common = common_parameters(prior, law);
  if (common.empty() || !(size.spheres > 0)) return done;
  // to the spheres at hand, and where few of the packings tell a parameter, by its degrees of freedom, to those of these
  const auto carried = [&](std::size_t i) {
    const double told = law.estimates[i].degrees_of_freedom + 1, packings = static_cast<double>(size.packings);
    return prior.size.spheres / size.spheres * (told < kFew * packings ? packings / told : 1);
  };
  const auto n = static_cast<Eigen::Index>(common.size());

  // Whether it applies. Variances of parameters that hang together are less than n numbers: of n equal ones there is one.
  const Eigen::MatrixXd V0 = prior.covariance(common, common);
  const Eigen::VectorXd scale = V0.diagonal().cwiseSqrt().cwiseInverse();
  const double independent = static_cast<double>(n * n) / (scale.asDiagonal() * V0 * scale.asDiagonal()).squaredNorm();
  double sum = 0, of_chance = 0;
  for (const std::size_t i : common) {
    const auto k = static_cast<Eigen::Index>(i);
    const double d = law.estimates[i].degrees_of_freedom;
    sum += std::log(variance(law, i) / (carried(i) * prior.covariance(k, k))) - mean_log(d);
    of_chance += variance_of_log(d) + variance_of_log(prior.degrees_of_freedom(k));
  }
  const double parameters = static_cast<double>(n);
  done.ratio = std::exp(sum / parameters);
  done.largest_ratio = kOtherMaterial * std::exp(kChance * std::sqrt(of_chance / parameters / independent));
  if (std::abs(std::log(done.ratio)) > std::log(done.largest_ratio)) return done;

  Eigen::VectorXd of_prior = Eigen::VectorXd::Zero(law.covariance.rows());
  Eigen::VectorXd of_ours = Eigen::VectorXd::Ones(law.covariance.rows());
  for (const std::size_t i : common) {
    const auto k = static_cast<Eigen::Index>(i);
    const double d = law.estimates[i].degrees_of_freedom, d0 = prior.degrees_of_freedom(k);
    of_prior(k) = std::sqrt(carried(i) * d0 / (d0 + d));
    of_ours(k) = std::sqrt(d / (d0 + d));
    law.estimates[i].degrees_of_freedom = d0 + d;
  }
  const Eigen::MatrixXd from_prior = of_prior.asDiagonal() * prior.covariance * of_prior.asDiagonal();
  const Eigen::MatrixXd from_ours = of_ours.asDiagonal() * law.covariance * of_ours.asDiagonal();
  law.covariance = from_prior + from_ours;
  for (const std::size_t i : common) {
    const auto k = static_cast<Eigen::Index>(i);
    law.estimates[i].standard_error = std::sqrt(law.covariance(k, k));
  }
  done.parameters = static_cast<int>(n);
  return done;
}

}  // namespace grainlaw::fit
