#pragma once
// What a setting of the engine costs, and how far its results are from those of a reference: the same packings (by seed) at
// every setting, quantities of the law from each packing by itself, differences from the reference averaged over the
// packings. Costs are counted in particle-steps; seconds are beside them.

#include <string>
#include <utility>
#include <vector>

#include "app/files/dataset.hpp"
#include "app/files/spec_file.hpp"

namespace grainlaw::app {

/// Keys of SPEC and the values to give them.
using Changes = std::vector<std::pair<std::string, Json>>;

struct Setting {
  std::string name;  ///< "base", "reference", "time_step_fraction=0.2", ...
  Changes changes;   ///< of the base
  Spec spec;
};

/// Parses "key=value": a number, else text. Throws InvalidInput.
std::pair<std::string, Json> change_from(const std::string& text);

/// The base spec with `changes`. Throws InvalidInput naming what the SPEC refuses.
Setting setting_of(const std::string& name, const Spec& base, const Changes& changes);

/// What one packing says of the law: P_star@nu and C_star@nu (Eqs. 11, 14), s_max@nu, beta_s@nu, F_max@nu, beta_F@nu
/// (Eqs. 17, 18), and nu_c (Eq. 14).
struct PackingQuantities {
  std::vector<std::string> names;
  std::vector<double> values;  ///< NaN where the packing does not show it [-]
};
PackingQuantities quantities_of(const Dataset& dataset, std::uint64_t seed);

/// A quantity at a setting, mean over the packings.
struct QuantityError {
  std::string quantity;
  double value = 0;           ///< [-]
  double error = 0;           ///< relative difference from the reference, mean over packings [-]
  double standard_error = 0;  ///< of `error`, from the scatter over packings [-]
};

struct SettingResult {
  Setting setting;
  double particle_steps = 0;  ///< of all packings and tests
  double seconds = 0;         ///< likewise, of one thread [s]
  std::vector<QuantityError> errors;
  double error = 0;        ///< root mean square of the errors over the quantities but nu_c [-]
  double floor = 0;        ///< likewise of their standard errors: what scatter alone makes [-]
  bool dominated = false;  ///< another setting costs less, and its error is not larger (the floor counts as reached)
};

/// `result` against `reference`, which has the same seeds. Errors of the reference itself are zero.
SettingResult compare_setting(const Setting& setting, const Dataset& result, const Dataset& reference);

/// Sets `dominated` of all but the first, the reference.
void find_dominated(std::vector<SettingResult>& results);

}  // namespace grainlaw::app
