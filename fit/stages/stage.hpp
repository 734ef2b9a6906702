#pragma once
// A stage of the calibration as data, and the one way in which all of them are run: fit, take over the values, add the
// errors of what was taken as given, judge, profile (docs/theory/fit.md, section Stages).

#include <functional>
#include <string>
#include <vector>

#include "fit/data/options.hpp"
#include "fit/statistics/inherited_error.hpp"
#include "fit/statistics/stage_fit.hpp"
#include "model/parameters.hpp"

namespace grainlaw::fit {

struct StageDefinition {
  std::string name;               ///< "coordination", "evolution", ...; that of its outcome
  std::string window;             ///< rows and weights in words, with numbers
  std::vector<std::string> free;  ///< names of parameter_table() in the order in which the blocks take them
  /// model - data; what is not free comes from the law as it was found so far. Empty: the stage is left out.
  std::function<std::vector<ResidualBlock>(const LawParameters<double>& law)> blocks;
  std::string remedy;   ///< which data would determine a parameter that the rows do not
  double least_nu = 1;  ///< smallest volume fraction of the rows; a free nu_c keeps kNearestJamming below it [-]
  /// Moves the free parameters of the law to where the search begins. Empty: they are there.
  std::function<void(LawParameters<double>& law)> start;
  std::vector<std::string> given;  ///< parameters of earlier stages, or groups of them, whose errors it inherits
  /// Withdraws claims that the data cannot carry; `law` is the fitted one.
  std::function<void(StageFit& fit, const LawParameters<double>& law)> judge;
  std::vector<NamedEstimate> absent;  ///< said of parameters that are not free because the data do not contain them
  bool coupled = false;               ///< the cost may have several minima: from as many starts as the options say
  bool profiled = false;              ///< doubtful parameters are profiled when the options say so
};

inline constexpr double kNearestJamming = 1e-4;  ///< nu - nu_c that the lowest row of a fit keeps

/// The names in parameter_table() of a group, their part up to the dot, in the order of the table.
std::vector<std::string> parameters_of(const std::string& group);

/// A stage whose data are missing: all `parameters` not identified, `remedy` as their note.
StageDefinition left_out(const std::string& name, const std::vector<std::string>& parameters,
                         const std::string& remedy);

/// The least-squares problem of the stage with `law` as found so far, as it is solved and as tests differentiate it.
Problem problem_of(const StageDefinition& stage, LawParameters<double> law, Loss loss = Loss::squares);

/// Runs the stage. `law` holds what was found so far and takes the values of the free parameters; `found` are the errors
/// so far. Throws Interrupted.
StageFit run_stage(const StageDefinition& stage, LawParameters<double>& law, const CalibrationOptions& options,
                   const RunControl& control, const FoundErrors& found = {});

}  // namespace grainlaw::fit
