#include "chain/uncertainty.hpp"

#include <fmt/format.h>

#include <cmath>

namespace grainlaw::chain {

predict::Uncertainty uncertainty_of(const fit::Calibration& calibration) {
  predict::Uncertainty uncertainty;
  std::vector<Eigen::Index> index;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!(calibration.covariance(k, k) > 0)) continue;
    index.push_back(k);
    uncertainty.parameters.push_back(i);
  }
  uncertainty.covariance = calibration.covariance(index, index);
  uncertainty.degrees_of_freedom.resize(static_cast<Eigen::Index>(index.size()));
  for (std::size_t k = 0; k < index.size(); ++k)
    uncertainty.degrees_of_freedom(static_cast<Eigen::Index>(k)) =
        calibration.estimates[uncertainty.parameters[k]].degrees_of_freedom;
  const fit::PackingScatter& scatter = calibration.scatter;
  uncertainty.scatter = {scatter.compression, scatter.s_par, scatter.F_par,
                         static_cast<double>(scatter.degrees_of_freedom)};
  return uncertainty;
}

std::string text_of(const predict::Uncertainty& uncertainty) {
  if (uncertainty.parameters.empty()) return "none: the parameters have no covariance; calibrate again";
  if (!std::isfinite(uncertainty.scatter.compression))
    return "95 %, of the mean curve only: the parameters have no scatter between packings; calibrate again, with two "
           "seeds or more";
  return "95 %, of the mean curve and of a single run";
}

}  // namespace grainlaw::chain
