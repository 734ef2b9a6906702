#pragma once
// The calibrated law along a strain path. Strain is the independent variable; the right-hand side is model's.
//   reduced:   Eqs. (17), (18) in closed form at the current nu, P by Eq. (14) (Figs. 12, 14 of the paper)
//   evolution: Eq. (16) by CVODE, stopped and re-initialised at each corner of the path; after every call y must be
//              finite and t equal to the requested output

#include <string>
#include <vector>

#include "model/evolution.hpp"
#include "model/path.hpp"
#include "model/run_control.hpp"
#include "model/test_record.hpp"

namespace grainlaw::predict {

enum class Model { reduced, evolution };
std::string to_string(Model model);

enum class Method { adams, bdf };

struct Tolerances {
  double relative = 1e-8;
  double absolute = 1e-12;       ///< on P*, sigma*, F
  Method method = Method::adams;
  long max_steps = 100000;       ///< internal steps per output interval
};

/// Where an output is wanted: a segment of the path and the path parameter in it, both not decreasing.
struct OutputPoint {
  int segment = 0;
  double e = 0;
};

/// `per_segment` equal intervals on each segment, ends included.
std::vector<OutputPoint> uniform_points(const std::vector<StraightSegment>& segments, int per_segment);

/// The points at which the rows of a test lie on its own path. Throws InvalidInput naming a row that is off the path.
std::vector<OutputPoint> points_of(const TestRecord& test);

struct PredictedRow {
  int segment = 0;
  Strain strain;          ///< tension positive [-]
  double eps_vol = 0, eps_dev = 0, shear_path = 0, nu = 0;  ///< as in Observation [-]
  LawState<double> state; ///< P*, sigma'*, F'
  double s_dev = 0;       ///< |sigma'|/P [-]
  double s_par = 0;       ///< <sigma',N>/P along the path's first shear direction [-]
  double F_dev = 0, F_par = 0;  ///< likewise of fabric [-]
};

struct SolverStatistics {
  long steps = 0, rhs_evaluations = 0, error_test_failures = 0, nonlinear_iterations = 0, restarts = 0;
  double seconds = 0;     ///< wall time of the integration [s]
};

struct Prediction {
  Model model = Model::evolution;
  std::vector<PredictedRow> rows;      ///< ends early when the state unjams
  SolverStatistics statistics;
  bool unjammed = false;               ///< P reached zero (or nu the jamming density); rows end before it
  std::vector<std::string> warnings;   ///< e.g. "nu = 0.85 lies outside the calibrated range 0.68-0.82"
};

/// Calibrated ranges, for the warnings.
struct ValidRange {
  double nu_min = 0, nu_max = 1, eps_dev_max = 1e300;
};

/// P by Eq. (14) at `nu`, no deviators. Throws InvalidInput when nu is not above jamming.
LawState<double> state_from_law(const LawParameters<double>& parameters, double nu);

/// The state measured in the first row of a test.
LawState<double> state_from_row(const Observation& row);

/// Throws InvalidInput for a start that is not jammed or points off the path; NotConverged with segment, strain and the
/// solver's word when the solver fails, when y is not finite or t differs from the requested output.
Prediction predict(Model model, const LawParameters<double>& parameters, Coupling coupling,
                   const std::vector<StraightSegment>& segments, const LawState<double>& start,
                   const std::vector<OutputPoint>& points, const Tolerances& tolerances, const ValidRange& range,
                   const RunControl& control);

}  // namespace grainlaw::predict
