#pragma once
// parameters.json: the calibrated law as others read it. Doubles bit for bit; null where a parameter is not identified.

#include <filesystem>
#include <string>

#include "model/calibrated_law.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw {

struct ParametersFile {
  CalibratedLaw law;
  Json provenance;  ///< who made it, when and from what; null when not said
};

/// The document of parameters.json.
OrderedJson parameters_to_json(const ParametersFile& parameters);

/// `name` stands for the document in messages. Throws InvalidInput naming key and value.
ParametersFile parameters_from_json(const Json& document, const std::string& name);

/// SHA-256 of the law itself, whatever was rehearsed since and whoever wrote the file: of its document without these.
std::string law_digest(CalibratedLaw law);

void write_parameters(const std::filesystem::path& file, const ParametersFile& parameters);

/// Throws InvalidInput naming file and key. Parameters without value keep the table's start and must not be read.
ParametersFile read_parameters(const std::filesystem::path& file);

/// An estimate as it stands there and in calibration.json: {value, standard_error, degrees_of_freedom, interval_95, status,
/// note}; value null when not identified, interval_95 left out without an error, note when empty.
void to_json(OrderedJson& object, const Estimate& estimate);

/// Throws InvalidInput when the value is null although the status promises one, or the reverse.
void from_json(const Json& object, Estimate& estimate);

}  // namespace grainlaw
