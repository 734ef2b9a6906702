#pragma once
// Foreign series and particles as a data set: read by a mapping, shown, checked like our own, moved onto their paths, written.

#include <filesystem>
#include <string>
#include <vector>

#include "chain/import/foreign_rows.hpp"
#include "chain/import/mapping.hpp"
#include "model/files/dataset.hpp"
#include "model/files/execution.hpp"

namespace grainlaw::chain {

/// A test as it was read.
struct ForeignTest {
  TestMapping mapping;
  ForeignRows foreign;
};

/// Reads what the mapping names and says what it takes each column for. Throws InvalidInput naming file, row and column.
std::vector<ForeignTest> read_foreign(const Mapping& mapping, const Execution& execution);

/// A test on its path, checked.
struct ImportedTest {
  TestRecord record;
  std::vector<std::string> says;  ///< the path and how far rows were from it, in words
  OrderedJson provenance = OrderedJson::object();
};

/// The test's path, given or found, with the rows on it. Throws InvalidInput naming file, row and column for whatever our own
/// series would be refused for, and for rows that are farther from the path than the tolerance.
ImportedTest imported(const Mapping& mapping, const ForeignTest& test);

/// What speaks against the units of a test: a pressure at its start that is 30 times off what unloading of the same packing has there.
std::vector<std::string> suspicions(const std::vector<ImportedTest>& tests);

/// The data set that they make. Throws InvalidInput naming the first test that cannot judge what others are fitted to.
Dataset dataset_of(const Mapping& mapping, const std::vector<ImportedTest>& tests);

/// Writes dataset.json, NAME.csv and, where columns were left over, NAME.extra.csv of each test, and reads it again. Throws as
/// dataset_of does, before anything is written.
Dataset write_imported(const Mapping& mapping, const std::vector<ForeignTest>& foreign,
                       const std::vector<ImportedTest>& tests, const std::filesystem::path& output,
                       const Execution& execution);

}  // namespace grainlaw::chain
