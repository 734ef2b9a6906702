#pragma once
// The Pareto figure of a study of settings: error reached over particle-steps, what sampling alone makes shaded, the default
// as a star, dominated settings grey.

#include "app/report/figure.hpp"
#include "chain/studies/settings_study.hpp"

namespace grainlaw::app::report {

Figure figure_of(const chain::SettingsStudy& study);

}  // namespace grainlaw::app::report
