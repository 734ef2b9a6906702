#pragma once
// An estimate with its error and standing, as it appears in parameters.json and calibration.json.

#include "model/files/json_document.hpp"
#include "fit/calibrate.hpp"

namespace grainlaw::chain {

/// {value, standard_error, status, note}; value null when not identified, note left out when empty.
OrderedJson estimate_to_json(const fit::Estimate& estimate);

/// Throws InvalidInput when the value is null although the status promises one, or the reverse.
fit::Estimate estimate_from_json(const Json& object);

}  // namespace grainlaw::chain
