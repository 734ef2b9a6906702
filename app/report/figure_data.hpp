#pragma once
// Figures of data that do not tell everything: a panel in which only laws would stand says nothing of the data.

#include "app/report/figure.hpp"

namespace grainlaw::app::report {

/// Whether there is data in the panel, or nothing that lacks them: it does not when a series of it has no point that can be drawn and
/// none with symbols, or thin as those of single runs, has.
bool shows_data(const Panel& panel);

/// Without the panels that show none, which the caption then names; perhaps without any panel.
Figure with_data(Figure figure);

}  // namespace grainlaw::app::report
