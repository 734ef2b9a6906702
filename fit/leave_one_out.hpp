#pragma once
// The calibration again without each packing in turn: a check of the errors that the fit states by linear theory, by the
// jackknife (docs/theory/fit.md, section Leave one out).

#include <vector>

#include "fit/calibrate.hpp"

namespace grainlaw::fit {

/// One fit for each seed of `tests`, none of a single one. Throws like calibrate() when nothing was left out; a part of the
/// data that cannot be fitted is returned with what it lacks.
std::vector<LeftOut> leave_one_out(const std::vector<TestRecord>& tests, const CalibrationOptions& options,
                                   const RunControl& control);

/// The jackknife's standard error of parameter number `i`; NaN when one of the fits does not identify it.
double jackknife_error(const std::vector<LeftOut>& fits, std::size_t i);

/// The fit that moved parameter number `i` furthest from `value`; null without one that identifies it.
const LeftOut* furthest(const std::vector<LeftOut>& fits, std::size_t i, double value);

}  // namespace grainlaw::fit
