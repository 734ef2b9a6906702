#pragma once
// "Did you mean": the known word that somebody may have meant.

#include <string>
#include <vector>

namespace grainlaw {

/// The first of those of `known` that are fewest edits from `word`, at most two and fewer than it has letters; empty when none is.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace grainlaw
