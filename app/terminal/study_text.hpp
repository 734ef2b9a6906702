#pragma once
// Studies as text.

#include <string>

#include "chain/studies/bands_study.hpp"
#include "chain/studies/settings_study.hpp"
#include "predict/studies/integrator_study.hpp"

namespace grainlaw::app {

/// A line for each setting, and whether the default is dominated.
std::string study_text(const chain::SettingsStudy& study);

/// The quickest way to the wanted error, by path and integrator, and the batch.
std::string study_text(const predict::IntegratorStudy& study);

/// Of each rung and path the shares of rows within the bands, then of all paths.
std::string study_text(const chain::BandsStudy& study);

}  // namespace grainlaw::app
