#pragma once
// What settings cost, how far their results are from those of a reference, and which of them others dominate
// (docs/theory/studies.md, sections Error of a setting and Dominance).
// An error is the root mean square over the quantities that a setting shows. What chance alone would do to it is its floor,
// and `reached` is what users of the setting get: the error beyond the floor, and on top of it the noise that they cannot
// average away. With the same packings at every setting errors count in units of the chance of their quantity, and the
// floor is one; where packings are chosen, too, errors are relative. Costs are counted in particle-steps. One setting
// dominates another if it costs no more, shows as much, is as safe from the energy balance's stop, and reaches less by more
// than chance explains.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "chain/studies/study_quantity.hpp"
#include "model/files/dataset.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::chain {

/// The changes that make one setting out of another: keys and the values to give them.
using Changes = std::vector<std::pair<std::string, Json>>;

enum class Packings {
  given,   ///< the same at every setting
  chosen,  ///< their number, too, belongs to a setting
};

struct Cost {
  double particle_steps = 0;  ///< of all runs
  double seconds = 0;         ///< likewise, of one thread [s]
  double fit_seconds = 0;     ///< of the fit, of all threads; 0: there is none [s]
};

/// Of the calibration tests; a run that gave several of them counts once.
Cost cost_of(const Dataset& dataset);

/// Largest energy residual of the calibration tests [-].
double energy_residual_of(const Dataset& dataset);

/// Whether it comes nearer than half to the residual that stops a run.
bool near_the_stop(double energy_residual);

/// Seeds of the calibration tests, ascending.
std::vector<std::uint64_t> packings_of(const Dataset& dataset);

/// What a setting has shown.
struct SettingOutcome {
  std::string name;  ///< "base", "reference", "time_step_fraction=0.2", ...
  Changes changes;   ///< of the base
  Cost cost;
  std::vector<std::uint64_t> seeds;  ///< of the packings, in the order of the influence's columns
  std::vector<StudyQuantity> quantities;
  std::vector<StudyQuantity> compared_with;  ///< the reference's by these packings; empty: by all of its own
  double energy_residual = 0;                ///< largest of the runs, dem::largest_energy_residual() [-]
  std::string model;                         ///< rung of the law that predicts; empty: none does
  std::string note;                          ///< what went wrong; may be empty
};

struct SettingResult {
  SettingOutcome outcome;
  std::vector<QuantityError> errors;                                  ///< the reference's quantities
  double error = 0, floor = 0, sampling = 0, noise = 0, reached = 0;  ///< NaN where nothing is shown [-]
  double reached_error = 0;               ///< of `reached`, by the jackknife; NaN with fewer than three packings [-]
  std::vector<std::string> dominated_by;  ///< settings that cost no more and reach less, beyond chance
  std::vector<std::string> perhaps_dominated_by;  ///< that cost less and reach as much or less, by what may be chance
};

struct SettingsStudy {
  std::string kind;   ///< "dem", "chain", "fit"
  std::string error;  ///< what an error is, in words
  Packings packings = Packings::given;
  Json base;               ///< what the changes are changes of
  std::size_t judged = 0;  ///< the default among `results`; those before it are a reference only
  std::vector<SettingResult> results;
};

/// Compares with the first of `outcomes`, and finds who dominates whom; a reference that is not judged takes no part.
SettingsStudy study_of(const std::string& kind, const std::string& error, Packings packings, const Json& base,
                       const std::vector<SettingOutcome>& outcomes, std::size_t judged);

/// What study.json holds, provenance aside.
OrderedJson study_to_json(const SettingsStudy& study);

/// What its figure shows, out of study.json: of the quantities nothing. Throws an exception of the JSON library for what is none.
SettingsStudy study_from_json(const Json& document);

}  // namespace grainlaw::chain
