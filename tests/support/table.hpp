#pragma once
// A table that a test measures, printed for scripts one row per line, the header first:
//   table NAME | cell | cell
// tests/acceptance/order_tables.sh collects them into docs/order-of-accuracy.md.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <string>
#include <vector>

namespace grainlaw::testing {

/// `name` has no blanks, e.g. "D1.order"; a cell has no '|'. Every row has as many cells as the header.
inline void print_table(const std::string& name, const std::vector<std::string>& header,
                        const std::vector<std::vector<std::string>>& rows) {
  fmt::print("table {} | {}\n", name, fmt::join(header, " | "));
  for (const auto& row : rows) fmt::print("table {} | {}\n", name, fmt::join(row, " | "));
  std::fflush(stdout);
}

}  // namespace grainlaw::testing
