#include "model/parameters_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "model/files/digest.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

OrderedJson covariance_to_json(const CalibratedLaw& law) {
  const std::vector<std::size_t> present = uncertain_parameters(law);
  OrderedJson names = OrderedJson::array(), matrix = OrderedJson::array();
  for (const std::size_t i : present) {
    names.push_back(parameter_table()[i].name);
    OrderedJson row = OrderedJson::array();
    for (const std::size_t j : present)
      row.push_back(law.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    matrix.push_back(row);
  }
  return {{"names", names}, {"matrix", matrix}};
}

OrderedJson rehearsals_to_json(const std::vector<Rehearsal>& rehearsals) {
  OrderedJson list = OrderedJson::array();
  for (const Rehearsal& rehearsal : rehearsals) {
    OrderedJson object = fields_to_json(rehearsal);
    object["path"] = path_to_json(rehearsal.path);
    list.push_back(object);
  }
  return list;
}

std::vector<Rehearsal> rehearsals_from_json(const Json& list, const std::string& name) {
  std::vector<Rehearsal> rehearsals;
  for (const Json& object : list) {
    Rehearsal& rehearsal = rehearsals.emplace_back();
    read_fields(object, rehearsal);
    rehearsal.path =
        path_from_json(object["path"], name, fmt::format("rehearsals[{}].path.", rehearsals.size() - 1), true);
  }
  return rehearsals;
}

constexpr int kVersion = 4;

/// Of files without the key, older ones: infinite, as if errors were exact.
double degrees_of_freedom(const Json& object) {
  if (object.contains("degrees_of_freedom")) return number_or_nan(object["degrees_of_freedom"]);
  return object.at("standard_error").is_null() ? std::nan("") : std::numeric_limits<double>::infinity();
}

/// Whether a parameter is of the memory rung of an earlier program, which was another law (docs/decisions/0005-memory-law.md).
bool of_earlier_memory(const Json& document, const std::string& name) {
  return document["format_version"] < kVersion && name.starts_with("memory.");
}

void read_covariance(const Json& document, Eigen::MatrixXd& covariance) {
  const Json &names = document["covariance"]["names"], &matrix = document["covariance"]["matrix"];
  std::vector<Eigen::Index> index;  // -1: not read
  for (const std::string name : names)
    index.push_back(of_earlier_memory(document, name) ? -1 : static_cast<Eigen::Index>(parameter_index(name)));
  if (matrix.size() != index.size())
    throw InvalidInput("covariance.matrix: needs one row for each of covariance.names");
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (matrix[i].size() != index.size())
      throw InvalidInput(fmt::format("covariance.matrix[{}]: needs {} numbers", i, index.size()));
    for (std::size_t j = 0; j < index.size(); ++j) {
      if (index[i] >= 0 && index[j] >= 0) covariance(index[i], index[j]) = matrix[i][j].get<double>();
    }
  }
}

}  // namespace

void to_json(OrderedJson& object, const Estimate& estimate) {
  const bool has_value = estimate.status != Status::not_identified;
  object = OrderedJson::object();
  object["value"] = has_value ? number_or_null(estimate.value) : OrderedJson(nullptr);
  object["standard_error"] = has_value ? number_or_null(estimate.standard_error) : OrderedJson(nullptr);
  if (!has_value || !std::isinf(estimate.degrees_of_freedom))  // without the key: infinite
    object["degrees_of_freedom"] = has_value ? number_or_null(estimate.degrees_of_freedom) : OrderedJson(nullptr);
  const double half = has_value ? estimate.half_width() : std::nan("");
  if (std::isfinite(half)) object["interval_95"] = {estimate.value - half, estimate.value + half};
  object["status"] = to_string(estimate.status);
  if (!estimate.note.empty()) object["note"] = estimate.note;
}

void from_json(const Json& object, Estimate& estimate) {
  estimate = {number_or_nan(object.at("value")), number_or_nan(object.at("standard_error")),
              value_of<Status>(object.at("status").get<std::string>(), "status"), object.value("note", ""),
              degrees_of_freedom(object)};
  if ((estimate.status == Status::not_identified) != std::isnan(estimate.value)) {
    throw InvalidInput(
        fmt::format("value: must be null exactly when the status is '{}'", to_string(Status::not_identified)));
  }
}

OrderedJson parameters_to_json(const ParametersFile& parameters) {
  const CalibratedLaw& law = parameters.law;
  const auto values = fields(law.parameters);
  OrderedJson document = OrderedJson::object();
  document["format"] = "grainlaw parameters";
  document["format_version"] = kVersion;
  document["coupling"] = to_string(law.coupling);
  document["converged"] = law.converged;
  OrderedJson& table = document["parameters"] = OrderedJson::object();
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const Estimate& estimate = law.estimates[i];
    OrderedJson entry = estimate;
    // the law's own value, so that what is predicted is what was fitted; forgotten where others of its group are not known
    if (estimate.status != Status::not_identified && !std::isnan(*values[i])) entry["value"] = *values[i];
    entry["symbol"] = info.symbol;
    entry["equation"] = info.equation;
    table[info.name] = entry;
  }
  document["covariance"] = covariance_to_json(law);
  document["scatter"] = fields_to_json(law.scatter);
  document["ranges"] = {{"nu", {law.range.nu_min, law.range.nu_max}},
                        {"eps_dev", {0.0, law.range.eps_dev_max}},
                        {"eps_vol", {0.0, law.range.eps_vol_max}},
                        {"shear_path", {0.0, law.range.shear_path_max}}};
  if (!law.rehearsals.empty()) document["rehearsals"] = rehearsals_to_json(law.rehearsals);
  if (!law.dataset_digest.empty()) document["dataset_digest"] = law.dataset_digest;
  if (!parameters.provenance.is_null()) document["provenance"] = OrderedJson(parameters.provenance);
  return document;
}

std::string law_digest(CalibratedLaw law) {
  law.rehearsals.clear();
  return sha256(parameters_to_json({std::move(law), {}}).dump());
}

ParametersFile parameters_from_json(const Json& document, const std::string& name) {
  check_schema(document, Schema::parameters, name);
  ParametersFile result;
  CalibratedLaw& law = result.law;
  law.coupling = document["coupling"] == "single" ? Coupling::single : Coupling::energy;
  law.converged = document.value("converged", false);
  law.parameters = start_parameters();
  law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    law.estimates[i] = {std::nan(""), std::nan(""), Status::not_identified,
                        of_earlier_memory(document, parameter_table()[i].name)
                            ? "the file is older than the memory rung of this program"
                            : "not in the file"};
  }
  try {
    const auto values = fields(law.parameters);
    for (const auto& item : document["parameters"].items()) {
      if (of_earlier_memory(document, item.key())) continue;
      const std::size_t i = parameter_index(item.key());
      Estimate& estimate = law.estimates[i];
      const ParameterInfo& info = parameter_table()[i];
      try {
        item.value().get_to(estimate);
      } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("parameters.{}.{}", info.name, error.what()));
      }
      if (estimate.status == Status::not_identified) continue;
      if (!(estimate.value >= info.lower && estimate.value <= info.upper)) {
        throw InvalidInput(fmt::format("parameters.{}.value: {} is outside its bounds [{}, {}]", info.name,
                                       estimate.value, info.lower, info.upper));
      }
      *values[i] = estimate.value;
    }
    if (document.contains("covariance")) read_covariance(document, law.covariance);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, one_line(error.what())));
  }
  forget_unknown_fabric(law);
  if (document.contains("scatter")) read_fields(document["scatter"], law.scatter);
  const Json& ranges = document["ranges"];
  law.range.nu_min = ranges["nu"][0];
  law.range.nu_max = ranges["nu"][1];
  law.range.eps_dev_max = ranges["eps_dev"][1];
  law.range.eps_vol_max = ranges["eps_vol"][1];
  // older files do not say it: their tests sheared one way
  law.range.shear_path_max =
      ranges.contains("shear_path") ? ranges["shear_path"][1].get<double>() : law.range.eps_dev_max;
  if (document.contains("rehearsals")) law.rehearsals = rehearsals_from_json(document["rehearsals"], name);
  law.dataset_digest = document.value("dataset_digest", "");
  result.provenance = document.value("provenance", Json());
  return result;
}

void write_parameters(const std::filesystem::path& file, const ParametersFile& parameters) {
  write_json(file, parameters_to_json(parameters));
}

ParametersFile read_parameters(const std::filesystem::path& file) {
  return parameters_from_json(read_json(file, JsonSource::own), one_line(file.string(), 200));
}

}  // namespace grainlaw
