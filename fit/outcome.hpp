#pragma once
// What a calibration says: values, errors and their standing, stage by stage. Plain values, nothing of the solver.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "model/vocabulary/path.hpp"

namespace grainlaw::fit {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();  ///< written as null

enum class Status {
  fitted,          ///< free in the last stage that it appears in
  fixed,           ///< not fitted by decision (Eq. (20)'s nu_c)
  tied,            ///< follows from others by an identity
  at_bound,        ///< ended on a physical bound; no standard error
  not_identified,  ///< the data do not contain it; no value and no standard error
};
constexpr auto names_of(Status) { return std::array{"fitted", "fixed", "tied", "at_bound", "not_identified"}; }

struct Estimate {
  double value = 0;                    ///< not to be read when not identified
  double standard_error = kUndefined;  ///< over packings, covariance.hpp; NaN unless fitted or tied
  Status status = Status::not_identified;
  std::string note;                        ///< why, e.g. which experiment would identify it; may be empty
  double degrees_of_freedom = kUndefined;  ///< of the standard error; NaN without one

  /// Half of the 95 % interval, by Student's t; NaN without an error.
  double half_width() const;
};

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

/// Cost of a stage with one parameter held and all others fitted again, profile.hpp.
struct ProfilePoint {
  double value = 0;   ///< of the parameter
  double excess = 0;  ///< of the cost, in units of that at the ends of the 95 % interval; NaN: model not defined
};
struct Profile {
  std::string parameter;
  std::string reason;                ///< why it was looked at
  double lower = 0, upper = 0;       ///< ends of the 95 % interval; NaN: not bounded within the parameter's bounds
  std::vector<ProfilePoint> points;  ///< values ascending
  std::string experiment;            ///< what would narrow it; may be empty
};

/// Where solutions from several starts ended, many_starts.hpp.
struct StartSearch {
  int tried = 1, at_minimum = 1;  ///< starts; those that ended at the lowest cost
  double next_cost = kUndefined;  ///< of the next minimum; NaN: there is none
};

/// A calibration without one packing, leave_one_out.hpp.
struct LeftOut {
  std::uint64_t seed = 0;     ///< of the packing
  std::vector<double> value;  ///< in the order of parameter_table(); NaN where not identified
  std::string note;           ///< what went wrong; may be empty
};

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

/// Eqs. (17) and (18) on one constant-volume test, and its steady means.
struct ShearFit {
  std::string test;
  Mode mode = Mode::D2;
  std::uint64_t seed = 0;
  double nu = 0;                                        ///< volume fraction of the test [-]
  double lode = 0;                                      ///< l of its shear, LawDirection [-]
  double eps_dev_max = 0;                               ///< deviatoric strain reached [-]
  Estimate s_max, beta_s, F_max, beta_F;                ///< of the fits; one run, hence without standard error
  double s_0 = 0, F_0 = 0;                              ///< start values, measured in the first row [-]
  double s_steady = 0, F_steady = 0;                    ///< steady means; NaN when the test ends before steady_from [-]
  double C_star = 0, rattler_fraction = 0, P_star = 0;  ///< steady means, likewise [-]
  double steady_from = 0;                               ///< eps_dev from which these means are taken [-]
  double steady_since_s = 0, steady_since_F = 0,
         steady_since_P = 0;  ///< detected onsets, steady_state.hpp; NaN: none [-]
};

}  // namespace grainlaw::fit
