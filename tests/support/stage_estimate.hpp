#pragma once
// What a stage says of one parameter.

#include <stdexcept>
#include <string>

#include "fit/stages/stage_fit.hpp"

namespace grainlaw::testing {

/// Throws when the stage says nothing of it.
inline const Estimate& estimate(const fit::StageFit& fit, const std::string& name) {
  for (const fit::NamedEstimate& e : fit.stage.estimates) {
    if (e.name == name) return e.estimate;
  }
  throw std::out_of_range("no estimate of " + name);
}

}  // namespace grainlaw::testing
