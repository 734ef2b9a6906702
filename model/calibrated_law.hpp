#pragma once
// The law with the values that a calibration gave it, and how well it knows them: what fit::calibrate() returns, what
// parameters.json holds (parameters_file.hpp) and what predictions read.

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/law.hpp"
#include "model/parameters.hpp"
#include "model/rehearsals.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw {

enum class Status {
  fitted,          ///< free in the last stage that it appears in
  fixed,           ///< not fitted by decision (Eq. (20)'s nu_c)
  tied,            ///< follows from others by an identity
  at_bound,        ///< ended on a physical bound; no standard error
  not_identified,  ///< the data do not contain it; no value and no standard error
};
constexpr auto names_of(Status) { return std::array{"fitted", "fixed", "tied", "at_bound", "not_identified"}; }

/// One parameter as the data determine it.
struct Estimate {
  double value = 0;                                                  ///< not to be read when not identified [-]
  double standard_error = std::numeric_limits<double>::quiet_NaN();  ///< over packings; NaN unless fitted or tied [-]
  Status status = Status::not_identified;
  std::string note;  ///< why, e.g. which experiment would identify it; may be empty
  double degrees_of_freedom = std::numeric_limits<double>::quiet_NaN();  ///< of the standard error; NaN without one

  /// Half of the 95 % interval, by Student's t; NaN without an error.
  double half_width() const;
};

/// How far runs of one path on different packings lie apart: what a single run adds to the error of a mean curve. Standard
/// deviations; NaN where no path was run on two packings.
struct PackingScatter {
  int packings = 0;                                               ///< most runs of one path
  double degrees_of_freedom = 0;                                  ///< of the least known of the three
  double compression = std::numeric_limits<double>::quiet_NaN();  ///< of P*/B*, B* of ISO unloading [-]
  double s_par = std::numeric_limits<double>::quiet_NaN();        ///< of s_par [-]
  double F_par = std::numeric_limits<double>::quiet_NaN();        ///< of F_par [-]
};
GRAINLAW_FIELDS(PackingScatter, packings, degrees_of_freedom, compression, s_par, F_par);

/// What the calibration has seen; outside, predictions are extrapolations. Without limits by default.
struct ValidRange {
  double nu_min = 0, nu_max = 1;                    ///< volume fraction of the rows that entered [-]
  double eps_dev_max = 1e300, eps_vol_max = 1e300;  ///< largest |strain| from the start of a test [-]
  double shear_path_max = 1e300;                    ///< longest shear path of a test [-]
};

struct CalibratedLaw {
  Coupling coupling = Coupling::energy;
  LawParameters<double>
      parameters;  ///< not identified ones stay at their start (the fabric's: NaN) and must not be read
  std::array<Estimate, kParameterCount> estimates;  ///< in the order of parameter_table()
  Eigen::MatrixXd covariance;  ///< kParameterCount square, zero where there is no error; its degrees of freedom are the
                               ///< estimates'
  PackingScatter scatter;      ///< between runs of one path on different packings
  ValidRange range{0, 0, 0, 0, 0};    ///< of the rows that entered
  bool converged = false;             ///< all stages of the fit
  std::string dataset_digest;         ///< of the data set that was fitted; may be empty
  std::vector<Rehearsal> rehearsals;  ///< paths that no fit saw, each with how far the law is off; may be none
};

/// Whether the 95 % interval of the parameter says nothing: its half width is more than the parameter's own value and more
/// than its plausible size (where a fit would start; of Q_limit that of its Q_c; of a jamming density .02).
bool says_nothing(const CalibratedLaw& law, std::size_t parameter);

/// Whether every parameter of `group` (a name in parameter_table() up to its dot) has a value, i.e. is identified.
bool has_values(const CalibratedLaw& law, std::string_view group);

/// Whether data tell any parameter of `group`: one is fitted. Else all are decided, taken as published or from elsewhere.
bool is_told(const CalibratedLaw& law, std::string_view group);

/// Whether the law says anything of the fabric, that is its laws of Eq. (20) have values.
bool knows_fabric(const LawParameters<double>& law);

/// Makes parameters of the fabric's laws, Eq. (20), that have no value NaN: the reduced rung, which is served without them, then says
/// nothing of the fabric.
void forget_unknown_fabric(CalibratedLaw& law);

/// Index in parameter_table() of the first parameter that `rung` needs and that has no value; nothing where the law can
/// serve the rung.
std::optional<std::size_t> missing_parameter(const CalibratedLaw& law, Rung rung);

/// Throws InvalidInput when `rung` needs a parameter that has no value, naming it and what would identify it. `name`
/// stands for the law in the message, e.g. the file that it was read from.
void require_parameters(const CalibratedLaw& law, Rung rung, const std::string& name);

/// What the law lacks for a rung, a line for all rungs that lack the same: "evolution, memory left out: parameters.X is not
/// identified", and what would identify it. None where it can serve all.
std::vector<std::string> left_out_rungs(const CalibratedLaw& law);

/// Rungs whose parameters all have values, cheapest first; none when even the reduced one lacks some.
std::vector<Rung> calibrated_rungs(const CalibratedLaw& law);

/// Indices in parameter_table() of the parameters that have an error: those that bands are made of.
std::vector<std::size_t> uncertain_parameters(const CalibratedLaw& law);

/// One line: which bands about a predicted curve the law's errors allow, or why there are none, and whether the law's own
/// error is in them.
std::string available_bands(const CalibratedLaw& law);

}  // namespace grainlaw
