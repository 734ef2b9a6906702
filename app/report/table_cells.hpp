#pragma once
// Columns and cells of the report's tables.

#include <limits>
#include <utility>

#include "app/report/number_text.hpp"
#include "app/report/page.hpp"

namespace grainlaw::app::report {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

inline TableColumn words(Text heading) { return {std::move(heading), TableColumn::Content::words}; }
inline TableColumn symbol(Text heading) { return {std::move(heading), TableColumn::Content::symbol}; }
inline TableColumn quantity(Text heading) { return {std::move(heading), TableColumn::Content::number}; }

inline Text number(double value, int digits = 4) { return plain(significant(value, digits)); }

}  // namespace grainlaw::app::report
