#pragma once
// Symbols of a DEM run: which rows are shown, which marker belongs to which seed, which colour to which density.

#include <cstdint>
#include <vector>

#include "app/report/figure.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::app::report {

using Quantity = double Observation::*;

/// About `points` rows of `test`, evenly spaced, as symbols of `y` against `x`.
Series dem_symbols(const TestRecord& test, Quantity x, Quantity y, int points, Text label, Colour colour,
                   Marker marker);

/// Seeds of the tests, ascending, each once.
std::vector<std::uint64_t> seeds_of(const std::vector<TestRecord>& tests);

/// Marker and colour of the i-th seed (or density), repeating after the last.
Marker marker_of(std::size_t i);
Colour colour_of(std::size_t i);

/// Position of `value` in `sorted`; sorted.size() when absent.
std::size_t index_of(const std::vector<std::uint64_t>& sorted, std::uint64_t value);

/// Starting densities of the tests, ascending; those closer than 1e-6 are one.
std::vector<double> densities_of(const std::vector<const TestRecord*>& tests);

/// Number of seeds in words, e.g. "2 seeds".
std::string seed_count(const std::vector<TestRecord>& tests);

/// Modes of the path, e.g. "D2", "D2→ISO→ISO".
std::string kind_of(const Path& path);

}  // namespace grainlaw::app::report
