#pragma once
// Studies as figures.

#include "app/report/figure.hpp"
#include "chain/studies/settings_study.hpp"
#include "predict/studies/integrator_study.hpp"

namespace grainlaw::app::report {

/// Settings: error reached over particle-steps, what sampling alone makes shaded, the default as a star, dominated ones grey.
Figure figure_of(const chain::SettingsStudy& study);

/// Integrators: right-hand sides and time over the error reached, a panel for each path.
Figure figure_of(const predict::IntegratorStudy& study);

}  // namespace grainlaw::app::report
