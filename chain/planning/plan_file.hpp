#pragma once
// plan.json: what a target of a calibration asked for, what the pilot found, which plans were considered and what was reached.

#include <filesystem>

#include "model/files/json_document.hpp"
#include "chain/planning/target_run.hpp"

namespace grainlaw::chain {

/// `overrides`: keys of the user's SPEC that the plan has replaced, with their values in the last round.
OrderedJson plan_to_json(const TargetRun& run, const PrecisionTarget& target, const Json& overrides,
                         const OrderedJson& provenance);

}  // namespace grainlaw::chain
