#pragma once
// One stage of the calibration: solve, then say what is known of each free parameter and how each test is met. What a stage
// says (Stage) is made of plain values, nothing of the solver.

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "fit/statistics/search.hpp"
#include "model/calibrated_law.hpp"

namespace grainlaw::fit {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();  ///< written as null

struct NamedEstimate {
  std::string name;  ///< of parameter_table()
  Estimate estimate;
};

/// Misfit of one test in one stage.
struct TestResidual {
  std::string test;
  std::string quantity;     ///< "P_star", "s_par", "F_par", "C_star", ...
  bool in_cost = true;      ///< false: shown, not fitted (the stage's window says why)
  int rows = 0;             ///< rows that entered
  int rows_excluded = 0;    ///< rows of the test outside the window (nu <= nu_c, strain window)
  int rows_lightened = 0;   ///< by Huber's loss, rows in the cost that count for less than half
  double rms = 0;           ///< root mean square of model - data in the unit of the quantity
  double bias = 0;          ///< mean of model - data
  double max_abs_data = 0;  ///< to normalise by
};
GRAINLAW_FIELDS(TestResidual, test, quantity, in_cost, rows, rows_excluded, rows_lightened, rms, bias, max_abs_data);

/// Cost of a stage with one parameter held and all others fitted again, profile.hpp.
struct ProfilePoint {
  double value = 0;   ///< of the parameter
  double excess = 0;  ///< of the cost, in units of that at the ends of the 95 % interval; NaN: model not defined
};
GRAINLAW_FIELDS(ProfilePoint, value, excess);
struct Profile {
  std::string parameter;
  std::string reason;                ///< why it was looked at
  double lower = 0, upper = 0;       ///< ends of the 95 % interval; NaN: not bounded within the parameter's bounds
  std::vector<ProfilePoint> points;  ///< values ascending
  std::string experiment;            ///< what would narrow it; may be empty
};
/// But the experiment, a key only where there is one.
GRAINLAW_SOME_FIELDS(Profile, parameter, reason, lower, upper, points);

/// What a stage says.
struct Stage {
  std::string name;    ///< "coordination", "steady_pressure", "evolution", ...
  std::string window;  ///< rows and weights in words, with numbers
  int residuals = 0, free_parameters = 0, iterations = 0;
  double initial_cost = 0, final_cost = 0;  ///< half the sum of squared weighted residuals
  std::string termination;                  ///< Ceres's word and message
  bool converged = false;
  double seconds = 0;
  std::vector<TestResidual> tests;
  StartSearch starts;
  std::vector<Profile> profiles;         ///< of the doubtful parameters, when asked for
  std::vector<NamedEstimate> estimates;  ///< of the parameters free in this stage; a later stage may refine them
};
/// The keys that come first; profiles, estimates and tests follow.
GRAINLAW_SOME_FIELDS(Stage, name, window, residuals, free_parameters, iterations, initial_cost, final_cost, termination,
                     converged, seconds, starts);

struct StageFit {
  Stage stage;                ///< its estimates are those of the free parameters, in their order
  Eigen::MatrixXd influence;  ///< of the packings on the free parameters, covariance.hpp; zero where there is no error
  Solution solution;

  Eigen::MatrixXd covariance() const { return influence * influence.transpose(); }

  /// Place of a free parameter; -1: it is none.
  Eigen::Index find(const std::string& name) const;

  /// Withdraws the claim on `name`: no error, `note` says which data would determine it.
  void mark_not_identified(const std::string& name, const std::string& note);
};

/// Solves. Estimates: at_bound without error; not_identified when the singular values say so, with `remedy` as note;
/// else fitted with the cluster-robust error, NaN with a note when it rests on a single packing.
StageFit fit_stage(const std::string& name, const std::string& window, const Problem& problem,
                   const std::string& remedy, int threads, const RunControl& control, int starts = 1);

}  // namespace grainlaw::fit
