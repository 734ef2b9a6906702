#pragma once
// A figure as a file of its own, in the colours of the page; light ones in viewers without CSS variables.

#include <filesystem>

#include "app/report/figure.hpp"

namespace grainlaw::app::report {

void write_svg(const std::filesystem::path& file, const Figure& figure);

}  // namespace grainlaw::app::report
