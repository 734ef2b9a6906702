#pragma once
// Documents against the draft-07 schemas of docs/schemas, which are built into the program. What a message tells the
// user to give comes from the schema: type, range and description of the key.

#include <array>
#include <string>
#include <vector>

#include "model/files/json_document.hpp"

namespace grainlaw {

enum class Schema { spec, path, test, dataset, parameters, study, study_settings, plan, prior, mapping };
/// As the files docs/schemas/NAME.schema.json are called.
constexpr auto names_of(Schema) {
  return std::array{"spec",  "path",           "test", "dataset", "parameters",
                    "study", "study_settings", "plan", "prior",   "import"};
}

/// The schema with every reference replaced by what it refers to.
const Json& schema(Schema which);

/// Throws InvalidInput "NAME: KEY: got ...; give ..." for the first violation.
void check_schema(const Json& document, Schema which, const std::string& name);

/// Likewise all violations, one line each, the first one first; none for a document that obeys.
std::vector<std::string> schema_violations(const Json& document, Schema which, const std::string& name);

}  // namespace grainlaw
