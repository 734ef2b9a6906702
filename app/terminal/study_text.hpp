#pragma once
// Studies as text.

#include <string>

#include "chain/studies/settings_study.hpp"
#include "predict/studies/integrator_study.hpp"

namespace grainlaw::app {

/// A line for each setting, and whether the default is dominated.
std::string study_text(const chain::SettingsStudy& study);

/// The quickest way to the wanted error, by path and integrator, and the batch.
std::string study_text(const predict::IntegratorStudy& study);

}  // namespace grainlaw::app
