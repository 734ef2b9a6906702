#pragma once
// Many strain histories at once, from plain arrays: what a filter, a sweep or another program's time step asks for.

#include <cstddef>
#include <vector>

#include "model/law.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw::predict {

/// Histories of as many straight steps each, from the law's own start. Steps without strain are allowed.
struct StrainBatch {
  std::size_t paths = 0, steps = 0;
  const double* strain = nullptr;  ///< [paths][steps][6]: logarithmic strain since the start at the end of each step,
                                   ///< xx yy zz yz xz xy, tension positive [-]
  const double* nu = nullptr;      ///< [paths]: volume fraction at the start [-]
};

/// State at the end of each step, [paths][steps]: that of predict(), to `accuracy`, a relative tolerance in [1e-14, 1); zero
/// while unjammed. By dopri_5 as long as a state is clear of unjamming at the end of each step, otherwise the whole path as predict() does it;
/// Rung::reduced in closed form. The same for any number of threads. Throws InvalidInput naming path and step for strain that
/// is not finite or a volume fraction outside (0, kMaxVolumeFraction], or the start below jamming; NotConverged; Interrupted.
std::vector<LawState<double>> states_along(const StrainBatch& batch, const LawParameters<double>& parameters, Rung rung,
                                           Coupling coupling, double accuracy, int threads, const RunControl& control);

}  // namespace grainlaw::predict
