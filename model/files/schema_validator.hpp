#pragma once
// The one door to the schema library, which is slow to compile.

#include <string>
#include <vector>

#include "model/files/json_document.hpp"

namespace grainlaw {

/// Place of the first violation, outermost key first; array indices are decimal numbers. Empty vector: the document itself.
struct Violation {
  bool found = false;
  std::vector<std::string> place;
};

/// `schema` must be free of references. The violation deepest in the document comes first.
Violation first_violation(const Json& document, const Json& schema);

}  // namespace grainlaw
