#pragma once
// A probe as rows of a table. Here, as in dem/engine/averages, units are dropped: moduli over k/(2<r>).

#include <vector>

#include "dem/statics/elastic_moduli.hpp"
#include "model/vocabulary/probe_row.hpp"

namespace grainlaw::dem {

/// k/(2<r>): the stress of P* = 1 [Pa].
double stress_unit(const State& state);

/// One row for each step size of the probe; one without steps where nothing carries load.
std::vector<ProbeRow> rows_of(const ElasticProbe& probe, double stress_unit);

}  // namespace grainlaw::dem
