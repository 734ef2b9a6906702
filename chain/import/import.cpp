#include "chain/import/import.hpp"

#include <fmt/format.h>

#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {

std::vector<ForeignTest> read_foreign(const Mapping& mapping, const Execution& execution) {
  std::vector<ForeignTest> tests;
  for (const TestMapping& test : mapping.tests) {
    if (execution.stop.stop_requested()) throw Interrupted("interrupted; nothing was written");
    throw InvalidInput(fmt::format("{}: test {}: {} cannot be read yet", mapping.name, test.name, test.series ? "series" : "particles"));
  }
  return tests;
}

ImportedTest imported(const Mapping&, const ForeignTest&) { return {}; }

Dataset write_imported(const Mapping&, const std::vector<ForeignTest>&, const std::vector<ImportedTest>&,
                       const std::filesystem::path&, const Execution&) {
  return {};
}

}  // namespace grainlaw::chain
