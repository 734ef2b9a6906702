#pragma once
// One stage of the calibration: solve, then say what is known of each free parameter and how each test is met.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/outcome.hpp"
#include "fit/statistics/least_squares.hpp"

namespace grainlaw::fit {

struct StageFit {
  Stage stage;                ///< its estimates are those of the free parameters, in their order
  Eigen::MatrixXd influence;  ///< of the packings on the free parameters, covariance.hpp; zero where there is no error
  Solution solution;

  Eigen::MatrixXd covariance() const { return influence * influence.transpose(); }

  /// Withdraws the claim on `name`: no error, `note` says which data would determine it.
  void mark_not_identified(const std::string& name, const std::string& note);
};

/// Solves. Estimates: at_bound without error; not_identified when the singular values say so, with `remedy` as note;
/// else fitted with the cluster-robust error, NaN with a note when it rests on a single packing.
StageFit fit_stage(const std::string& name, const std::string& window, const Problem& problem,
                   const std::string& remedy, int threads, const RunControl& control, int starts = 1);

}  // namespace grainlaw::fit
