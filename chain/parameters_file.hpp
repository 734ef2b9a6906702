#pragma once
// parameters.json: the calibrated law as others read it. Doubles bit for bit; null where a parameter is not identified.

#include <filesystem>
#include <optional>
#include <string>

#include "model/files/json_document.hpp"
#include "fit/calibrate.hpp"
#include "predict/predict.hpp"

namespace grainlaw::chain {

struct ParametersFile {
  fit::Calibration calibration;  ///< without stages and shear fits, which calibration.json holds
  std::string dataset_digest;    ///< of the data set that was fitted; may be empty
  Json provenance;
};

void write_parameters(const std::filesystem::path& file, const ParametersFile& parameters);

/// Throws InvalidInput naming file and key. Parameters without value keep the table's start and must not be read.
ParametersFile read_parameters(const std::filesystem::path& file);

/// Index of the first parameter that `model` needs and that has no value.
std::optional<std::size_t> missing_parameter(const fit::Calibration& calibration, Rung model);

/// Throws InvalidInput when `model` needs a parameter that has no value, naming it and what would identify it.
void require_parameters(const ParametersFile& parameters, Rung model, const std::string& name);

}  // namespace grainlaw::chain
