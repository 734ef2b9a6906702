#pragma once
// parameters.json: the calibrated law as others read it. Doubles bit for bit; null where a parameter is not identified.

#include <filesystem>

#include "model/calibrated_law.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw {

struct ParametersFile {
  CalibratedLaw law;
  Json provenance;  ///< who made it, when and from what; null when not said
};

void write_parameters(const std::filesystem::path& file, const ParametersFile& parameters);

/// Throws InvalidInput naming file and key. Parameters without value keep the table's start and must not be read.
ParametersFile read_parameters(const std::filesystem::path& file);

}  // namespace grainlaw
