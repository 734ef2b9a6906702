#pragma once
// A study of settings as text: one line each, and whether the default is dominated.

#include <string>

#include "chain/studies/settings_study.hpp"

namespace grainlaw::app {

std::string study_table(const chain::SettingsStudy& study);

}  // namespace grainlaw::app
