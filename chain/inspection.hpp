#pragma once
// Any file or folder that the program reads: what it is, whether it is sound, and what a command would do with it.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chain/forecast.hpp"

namespace grainlaw::chain {

struct Inspection {
  std::string file;                       ///< as it was given
  std::string kind;                       ///< "SPEC", "PATH", "data set", ...; empty when it cannot be told
  std::vector<std::string> holds;         ///< what is in it, in words
  std::vector<std::string> refusals;      ///< all that is wrong with it; none: it is sound
  std::optional<Forecast> forecast = {};  ///< where a command would run or fit something
};

/// Of each of `files`, in their order. PATHs are seen in the light of the others: the range of a parameters.json, and the
/// runs by its spec, or by a SPEC. `output`: whose finished runs are found. Refusals are no errors here; throws Interrupted.
std::vector<Inspection> inspect(const std::vector<std::filesystem::path>& files, const std::filesystem::path& output,
                                const Execution& execution);

}  // namespace grainlaw::chain
