#pragma once
// From the data set to the parameters of the law, in stages (docs/formats.md, calibration.json):
//   1 density laws: Eqs. (11), (12), (14) on ISO unloading and on steady D2; Eq. (13); g3
//   2 shear: Eqs. (17), (18) per constant-volume test, windows of equations.md 0
//   3 Eq. (20) over density for s_max, beta_s, F_max, beta_F
//   4 evolution: Eq. (16) on all calibration trajectories at once, started from the staged values, exact derivatives
// Validation tests are refused here, not filtered silently.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "model/parameters.hpp"
#include "model/run_control.hpp"
#include "model/test_record.hpp"

namespace grainlaw::fit {

struct CalibrationOptions {
  Coupling coupling = Coupling::energy;
  double iso_nu_min = 0.675;        ///< ISO unloading rows below it leave the fit [-]
  double rate_window = 0.12;        ///< rates are fitted from the start of shear to this eps_dev [-]
  double steady_from = 0.15;        ///< steady means are taken from this eps_dev on [-]
  double max_step = 2e-3;           ///< largest step of the fixed-step integrator in path strain [-]
  int threads = 1;                  ///< results do not depend on it
};

enum class Status {
  fitted,          ///< free in the last stage that it appears in
  fixed,           ///< not fitted by decision (Eq. (20)'s nu_c)
  tied,            ///< follows from others by an identity
  at_bound,        ///< ended on a physical bound; no standard error
  not_identified,  ///< the data do not contain it; no value and no standard error
};
std::string to_string(Status status);

struct Estimate {
  double value = 0;
  double standard_error = 0;  ///< cluster-robust over runs (each test one cluster); NaN unless fitted or tied
  Status status = Status::not_identified;
  std::string note;           ///< why, e.g. which experiment would identify it; may be empty
};

/// Misfit of one test in one stage.
struct TestResidual {
  std::string test;
  std::string quantity;     ///< "P_star", "s_par", "F_par", "C_star", ...
  int rows = 0;             ///< rows that entered
  int rows_excluded = 0;    ///< rows of the test outside the window (nu <= nu_c, strain window)
  double rms = 0;           ///< root mean square of model - data in the unit of the quantity
  double bias = 0;          ///< mean of model - data
  double max_abs_data = 0;  ///< to normalise by
};

struct Stage {
  std::string name;          ///< "coordination", "steady_pressure", "evolution", ...
  std::string window;        ///< in words, with numbers
  int residuals = 0, free_parameters = 0, iterations = 0;
  double initial_cost = 0, final_cost = 0;  ///< half the sum of squared weighted residuals
  std::string termination;   ///< Ceres's word and message
  bool converged = false;
  double seconds = 0;
  std::vector<TestResidual> tests;
};

/// Eqs. (17) and (18) on one constant-volume test, and its steady means.
struct ShearFit {
  std::string test;
  Mode mode = Mode::D2;
  std::uint64_t seed = 0;
  double nu = 0;
  Estimate s_max, beta_s, F_max, beta_F;      ///< of the window fits; steady means enter s_max and F_max
  double s_0 = 0, F_0 = 0;                    ///< start values of the fits [-]
  double C_star = 0, rattler_fraction = 0, P_star = 0;  ///< steady means; NaN when the test ends before steady_from
};

struct Calibration {
  Coupling coupling = Coupling::energy;
  LawParameters<double> parameters;                    ///< not identified ones stay at their start and must not be read
  LawParameters<double> staged;                        ///< after stages 1-3, where the evolution stage starts from
  std::array<Estimate, kParameterCount> estimates;     ///< in the order of parameter_table()
  Eigen::MatrixXd covariance;                          ///< kParameterCount square, zero where there is no error
  std::vector<Stage> stages;
  std::vector<ShearFit> shear;
  double nu_min = 0, nu_max = 0;                       ///< range of volume fraction of the calibration tests
  double eps_dev_max = 0, eps_vol_max = 0;             ///< largest |strain| of the calibration tests
  bool converged = false;                              ///< all stages
};

/// Throws InvalidInput naming the test when a validation test, a test without rows or a non-finite value is given, or
/// when a stage lacks its tests (with the remedy). A stage that does not converge is reported, not thrown.
Calibration calibrate(const std::vector<TestRecord>& tests, const CalibrationOptions& options, const RunControl& control);

}  // namespace grainlaw::fit
