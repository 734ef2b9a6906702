#pragma once
// Figures of data that do not tell everything: a panel in which only laws would stand says nothing of the data.

#include "app/report/figure.hpp"

namespace grainlaw::app::report {

/// Without the panels that show none, which the caption then names; perhaps without any panel. A panel shows none when a series of it
/// has no point that can be drawn and none with symbols, or thin as those of single runs, has.
Figure with_data(Figure figure);

}  // namespace grainlaw::app::report
