#pragma once
// An estimate with its error and standing, as it appears in parameters.json and calibration.json.

#include "model/calibrated_law.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw {

/// {value, standard_error, status, note}; value null when not identified, note left out when empty.
OrderedJson estimate_to_json(const Estimate& estimate);

/// Throws InvalidInput when the value is null although the status promises one, or the reverse.
Estimate estimate_from_json(const Json& object);

}  // namespace grainlaw
