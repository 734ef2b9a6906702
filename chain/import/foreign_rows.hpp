#pragma once
// What was read of one test of others, in our units and signs, before anything of it was checked or written.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/files/json_document.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::chain {

/// What became of one column (or of one kind of file).
struct ColumnUse {
  std::string column;   ///< as it is called there
  std::string meaning;  ///< our column and what it is; empty: kept aside
  std::string unit;     ///< as it was read
  std::string sign;     ///< what is positive there; empty where there is no choice
};

/// Columns that the law's series has no place for, as they stand.
struct ExtraColumns {
  std::vector<std::string> titles;
  std::vector<std::vector<double>> rows;  ///< as many as the series has; NaN where empty or not finite
};

struct ForeignRows {
  /// Time, strain since the first row, nu, stress, and whatever else is known; the rest undefined, an absent fabric all NaN.
  std::vector<Observation> rows;
  /// "FILE: line 17, column 'sxx'" for messages: of a row, from 0, and one of our columns.
  std::function<std::string(std::size_t row, const std::string& column)> place;
  std::vector<ColumnUse> columns;
  std::vector<std::string> notes;  ///< what else was taken as given, e.g. signs that were evident
  ExtraColumns extra;
  OrderedJson provenance = OrderedJson::object();  ///< files with their digests, and how they were read
  std::optional<PackingInfo> packing;              ///< where the files say it themselves; none: the mapping's
};

}  // namespace grainlaw::chain
