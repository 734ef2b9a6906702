#pragma once
// The arithmetic of a plan: what a calibration with given settings is expected to know and to cost, from what a small pilot
// showed, and which settings are the cheapest for a wanted error. The error of a quantity, relative to its largest |value|
// on the path, is the half width of its band, carried over from settings that have shown it, together with three biases that
// more packings do not mend: of the strain rate, the time step and the size of the packings. Each bias is a slope, measured
// against a coarser setting, times a shape. Formulas: docs/theory/studies.md, section Wanted error.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw::chain {

/// What a plan chooses; everything else is the SPEC's.
struct PlanSettings {
  std::int64_t particles = 0;     ///< N of a packing
  int packings = 0;               ///< n
  double strain_rate = 0;         ///< [1/s]
  double time_step_fraction = 0;  ///< step over the shortest collision time [-]
  int densities = 0;              ///< D, at which shear tests start
  double shear_strain = 0;        ///< e, deviatoric strain of the shear tests [-]
};
GRAINLAW_FIELDS(PlanSettings, particles, packings, strain_rate, time_step_fraction, densities, shear_strain);

/// Whether finished packings of one serve the other.
bool same_packings(const PlanSettings& a, const PlanSettings& b);

/// Relative variances of the steady mean of a shear test to `shear_strain`: common to the tests of a packing, and not.
struct SteadyScatter {
  double shear_strain = 0;
  double between = 0, within = 0;
};
GRAINLAW_FIELDS(SteadyScatter, shear_strain, between, within);

enum class Cause { strain_rate, time_step, size };
constexpr auto names_of(Cause) { return std::array{"strain_rate", "time_step", "size"}; }
inline constexpr auto kCauses = kValues<Cause>;

/// What shapes are relative to.
struct Scale {
  PlanSettings pilot;
  double wanted_rate = 0;  ///< of the SPEC [1/s]
};
double shape(Cause cause, const PlanSettings& settings, const Scale& scale);

/// What makes results wrong by slope times shape.
struct Bias {
  double difference = 0;      ///< of the coarser setting from the pilot; NaN when none was run [-]
  double standard_error = 0;  ///< of it, likewise
  double slope = 0;           ///< [-]
  double resolution = 0;      ///< smallest slope that would have been seen: two standard errors [-]
};

/// From a difference between settings whose shapes lie `apart` > 0.
Bias bias_of(double difference, double standard_error, double apart);

struct QuantityFindings {
  std::string quantity;
  double half_width = 0;               ///< h_0; NaN: the pilot has no band [-]
  std::vector<SteadyScatter> scatter;  ///< one for each strain that a plan may choose
  std::array<Bias, 3> biases;          ///< in the order of kCauses
};

/// Seconds that work takes on this machine.
struct CostRates {
  double particle_step = 0;  ///< per sphere and step [s]
  double relaxed = 0;        ///< per sphere of a kept state, for its relaxation [s]
  double fitted_test = 0;    ///< per test that is fitted [s]
};

/// Work of one packing.
struct Work {
  double preparation = 0;   ///< particle-steps of its preparation
  double tests = 0;         ///< likewise of its tests
  double relaxed = 0;       ///< spheres of all its kept states
  double fitted_tests = 0;  ///< number of its tests
};

/// Work at settings that differ from `at` in size, rate and step alone.
Work scaled(const Work& work, const PlanSettings& at, const PlanSettings& settings);

struct PlanFindings {
  Scale scale;             ///< of the biases
  PlanSettings reference;  ///< what the half widths are those of
  std::vector<QuantityFindings> quantities;
  CostRates rates;
};

/// The findings with the half widths of another round.
PlanFindings rebased(PlanFindings findings, const PlanSettings& settings, const std::vector<double>& half_widths);

struct ExpectedError {
  std::string quantity;
  double half_width = 0;           ///< [-]
  std::array<double, 3> biases{};  ///< in the order of kCauses [-]
  double total() const;            ///< sqrt of the sum of squares
};
/// A quantity without a band counts as wholly unknown: half width 1.
ExpectedError expected(const QuantityFindings& quantity, const PlanFindings& findings, const PlanSettings& settings);

/// Settings with the packings that they need.
struct Candidate {
  PlanSettings settings;
  Work work;                          ///< of one packing
  std::vector<ExpectedError> errors;  ///< of the wanted quantities
  double error = 0;                   ///< the largest total of these [-]
  double seconds = 0;                 ///< of what is not finished yet, fit included [s]
  bool reaches = false;               ///< error <= target
};

/// The target and where one stands.
struct PlanGoal {
  double error = 0;                    ///< wanted [-]
  double seconds_left = 0;             ///< infinity: no limit [s]
  std::vector<PlanSettings> finished;  ///< of all rounds
  double error_now = 0;                ///< that the last one reached [-]
  int max_packings = 1000;
  std::vector<PlanSettings> without_band{};  ///< of the rounds that say nothing
};

/// What is expected of exactly these settings.
Candidate candidate_with(const PlanSettings& settings, const Work& work, const PlanFindings& findings,
                         const PlanGoal& goal);

/// `settings` with the smallest number of packings that reaches the goal; where that takes too long or is out of reach, with
/// as many as the seconds allow (without a limit: the fewest). At least three, more than are finished, and twice the spheres of
/// a round without a band that sheared as far at as many densities; no candidate without time for them.
std::optional<Candidate> candidate(const PlanSettings& settings, const Work& work, const PlanFindings& findings,
                                   const PlanGoal& goal);

/// Index of the cheapest that reaches the goal; where none does and the time is limited, of the smallest error below
/// error_now. Nothing: no candidate would help.
std::optional<std::size_t> choose(const std::vector<Candidate>& candidates, const PlanGoal& goal);

}  // namespace grainlaw::chain
