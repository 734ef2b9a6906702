#pragma once
// A figure in the page: legend and toggles that need no script, panels, caption, sources, and its numbers for the script.

#include <string>
#include <vector>

#include "app/report/figure.hpp"

namespace grainlaw::app::report {

std::string figure_html(const Figure& figure);
std::string drawing_html(const Drawing& drawing);

/// Names of files, parted by commas.
std::string code_list(const std::vector<std::string>& files);

/// `values` for a script, as JSON: [lowest, highest, characters], three characters of base 64 for each value, 0 at the lowest
/// and 262142 at the highest, 262143 where it is undefined; so the page keeps five digits of an axis in three characters. With a
/// fourth entry 1 they are the natural logarithms: with `logarithmic`, then undefined where not positive, and of positive values that
/// span more than a factor of 100, which keep five digits each.
std::string packed_numbers(const std::vector<double>& values, bool logarithmic);

/// Rules of style that hide what one of `count` toggles of a figure stands for.
std::string toggle_style(std::size_t count);

}  // namespace grainlaw::app::report
