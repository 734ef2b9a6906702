#pragma once
// One stage of the calibration: solve, then say what is known of each free parameter and how each test is met.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/statistics/least_squares.hpp"
#include "fit/options.hpp"
#include "fit/outcome.hpp"

namespace grainlaw::fit {

struct StageFit {
  Stage stage;                ///< its estimates are those of the free parameters, in their order
  Eigen::MatrixXd influence;  ///< of the packings on the free parameters, covariance.hpp; zero where there is no error
  Solution solution;

  Eigen::MatrixXd covariance() const { return influence * influence.transpose(); }

  /// Withdraws the claim on `name`: no error, `note` says which data would determine it.
  void mark_not_identified(const std::string& name, const std::string& note);
};

/// How the minimum is looked for.
struct Search {
  Loss loss = Loss::squares;
  int starts = 1;
};

/// Solves. Estimates: at_bound without error; not_identified when the singular values say so, with `remedy` as note;
/// else fitted with the cluster-robust error, NaN with a note when it rests on a single packing.
StageFit fit_stage(const std::string& name, const std::string& window, const std::vector<FreeParameter>& parameters,
                   const std::vector<ResidualBlock>& blocks, const std::string& remedy, int threads,
                   const RunControl& control, const Search& search = {});

/// A stage that was left out because its data are missing: all `parameters` not identified, `remedy` as their note.
StageFit skipped_stage(const std::string& name, const std::vector<std::string>& parameters, const std::string& remedy);

}  // namespace grainlaw::fit
