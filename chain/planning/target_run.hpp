#pragma once
// A calibration up to a wanted error of a prediction: a pilot, the cheapest plan by what it shows, the plan's runs, and more
// where the error that they reach is still too large. What simulates and fits is given, so that this is a strategy alone.

#include <functional>
#include <string>
#include <vector>

#include "chain/planning/precision_plan.hpp"
#include "chain/planning/prediction_error.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::chain {

struct PrecisionTarget {
  double error = 0.02;                  ///< wanted: largest total error of the quantities, over the largest |value| [-]
  std::vector<std::string> quantities;  ///< of P_star, s_par, F_par; those that are wanted
  Path path;                            ///< that of the prediction
  double max_seconds = 0;               ///< of everything together; 0: no limit [s]
};

/// What a target needs done. Finished simulations are kept between the calls.
struct TargetActions {
  std::function<PredictionError(const PlanSettings&)> calibrate;  ///< simulates and fits
  std::function<PlanFindings(const PredictionError&)> explore;    ///< the coarser settings, after calibrate(pilot)
  std::function<Work(const PlanSettings&)> work;                  ///< of one packing
  std::function<double()> seconds;                                ///< since the begin [s]
  std::function<void(const std::string&)> log;
};

enum class TargetOutcome { met, discrepancy, max_cost, no_band };
constexpr auto names_of(TargetOutcome) {
  return std::array{"met", "the law's own discrepancy is larger than the target",
                    "no plan that is left reaches it in the time allowed", "the prediction has no band"};
}

struct TargetRound {
  PlanSettings settings;
  double expected_error = 0;    ///< by the choice of the round; NaN for the pilot [-]
  double expected_seconds = 0;  ///< likewise [s]
  double seconds = 0;           ///< taken by the round [s]
  PredictionError known;
  std::vector<ExpectedError> errors;  ///< of the wanted quantities: bands reached, biases by the pilot
  double error = 0;                   ///< the largest total of these; NaN: no band [-]
};

struct TargetRun {
  TargetOutcome outcome = TargetOutcome::met;
  PlanFindings pilot;
  std::vector<Candidate> candidates;  ///< of the first choice, none when the pilot did
  std::vector<TargetRound> rounds;    ///< the first is the pilot
};

/// `grid` holds the settings to choose from; their numbers of packings are not read.
TargetRun reach(const PrecisionTarget& target, const PlanSettings& pilot, const std::vector<PlanSettings>& grid,
                const TargetActions& actions);

/// "12 packings of 800 spheres, 1000 1/s, step 0.1, 4 densities, shear to 0.3".
std::string text_of(const PlanSettings& settings);

/// "memory rung: P_star 1.2 % (band 1.1, rate ...)".
std::string text_of(const TargetRound& round);

/// What plan.json holds: what was asked for, what the pilot found, which plans were considered and what was reached.
/// `overrides`: keys of the user's SPEC that the plan has replaced, with their values in the last round.
OrderedJson plan_to_json(const TargetRun& run, const PrecisionTarget& target, const Json& overrides,
                         const OrderedJson& provenance);

}  // namespace grainlaw::chain
