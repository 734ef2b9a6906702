#pragma once
// What a calibration says of the errors of its law, as predictions need it for their bands.

#include <string>

#include "chain/parameters_file.hpp"
#include "predict/bands.hpp"

namespace grainlaw::chain {

/// Parameters with an error, their covariance, and the scatter between packings. Nothing where the file has none.
predict::Uncertainty uncertainty_of(const fit::Calibration& calibration);

/// One line: which bands there are, or why there are none.
std::string text_of(const predict::Uncertainty& uncertainty);

}  // namespace grainlaw::chain
