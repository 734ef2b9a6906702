#pragma once
// What settings cost, and how far their results are from those of a reference. Over the quantities of a setting,
//   error^2    = mean of their squared errors            floor^2    = mean of their squared standard errors
//   sampling^2 = mean of their squared 95 % intervals    reached^2  = max(error^2 - floor^2, 0) + noise^2
// error^2 - floor^2 estimates the square of what the setting itself does. The noise that comes on top is the floor where all
// settings have the same packings, of which only differences count, and sampling where packings are chosen, too: the interval
// is all that users of the setting have, and few packings do not know their own scatter (two: t = 12.7). Nor does a time step or
// a rate change how packings scatter: among settings that differ only in how they compute, floor and sampling are pooled (root mean
// square), lest a setting dominate by a scatter that happens to come out small.
// With the same packings each quantity counts in units of its own chance, its standard error pooled likewise: P_star is known to 1 %
// where F_max is to 10 and a rate beta to 30, and among relative errors the chance of the last would be all that is seen. The floor
// is one by definition, and an error of two is twice what chance does. Where packings are chosen errors are relative.
// A setting whose energy residual comes nearer than half to the one that stops a run dominates none that keeps away: its next data set
// may not be finished. Costs are counted in particle-steps; seconds are beside them.
// What is reached is known as well as a few packings tell. A setting that costs no more dominates where its reached^2 is less beyond
// chance: by t errors of the difference, t for one in twenty verdicts on a setting however many cost no more. That error is the
// jackknife's, each packing left out in turn of all settings that have it, and 2 floor^4 of both; the squares are those before max(),
// or chance below the floor would count as none. Where it is less but not beyond chance, a setting that costs less perhaps dominates.

#include <cstdint>
#include <string>
#include <vector>

#include "model/files/dataset.hpp"
#include "chain/studies/key_changes.hpp"
#include "chain/studies/study_quantity.hpp"

namespace grainlaw::chain {

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

}  // namespace grainlaw::chain
