#pragma once
// JSON of what checks a fit: likelihood profiles, solutions from several starts, fits without one packing.

#include "model/files/json_document.hpp"
#include "fit/calibrate.hpp"

namespace grainlaw::app {

OrderedJson profile_to_json(const fit::Profile& profile);
fit::Profile profile_from_json(const Json& object);

OrderedJson starts_to_json(const fit::StartSearch& starts);
fit::StartSearch starts_from_json(const Json& object);

/// Seeds, and per parameter with an error: values without each of them, stated and jackknife error; null without any fit.
OrderedJson left_out_to_json(const fit::Calibration& calibration);
/// Values of the parameters that the object names; NaN for the others.
std::vector<fit::LeftOut> left_out_from_json(const Json& object);

}  // namespace grainlaw::app
