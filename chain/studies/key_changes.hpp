#pragma once
// KEY=VALUE on the command line: the changes that make one setting of a study out of another.

#include <string>
#include <utility>
#include <vector>

#include "model/files/json_document.hpp"

namespace grainlaw::chain {

/// Keys and the values to give them.
using Changes = std::vector<std::pair<std::string, Json>>;

/// Parses "key=value": a number or a list as in JSON, else text. Throws InvalidInput.
std::pair<std::string, Json> change_from(const std::string& text);
Changes changes_from(const std::vector<std::string>& texts);

/// `document` with `changes`. A key may lead into what is there, e.g. "tests[1].strain". Throws InvalidInput when there is
/// nothing at such a place, naming `name`.
Json changed(Json document, const Changes& changes, const std::string& name);

}  // namespace grainlaw::chain
