#pragma once
// Stages one after another, as a calibration runs them, and what a stage says of one parameter.

#include <stdexcept>
#include <string>
#include <vector>

#include "fit/stages/stage.hpp"

namespace grainlaw::testing {

/// Throws when the stage says nothing of it.
inline const Estimate& estimate(const fit::StageFit& fit, const std::string& name) {
  for (const fit::NamedEstimate& e : fit.stage.estimates) {
    if (e.name == name) return e.estimate;
  }
  throw std::out_of_range("no estimate of " + name);
}

/// Runs the stages; each knows the values and errors of those before.
inline std::vector<fit::StageFit> run_stages(const std::vector<fit::StageDefinition>& stages,
                                             LawParameters<double>& law, const fit::CalibrationOptions& options = {}) {
  fit::FoundErrors found = fit::no_errors();
  std::vector<fit::StageFit> fits;
  for (const fit::StageDefinition& stage : stages) {
    fits.push_back(fit::run_stage(stage, law, options, {}, found));
    fit::add_errors(fits.back(), found);
  }
  return fits;
}

}  // namespace grainlaw::testing
