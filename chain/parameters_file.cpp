#include "chain/parameters_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "chain/estimate_json.hpp"
#include "model/files/schema.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

OrderedJson covariance_to_json(const fit::Calibration& c) {
  std::vector<std::size_t> present;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (c.covariance.rows() > k && c.covariance(k, k) > 0) present.push_back(i);
  }
  OrderedJson names = OrderedJson::array(), matrix = OrderedJson::array();
  for (const std::size_t i : present) {
    names.push_back(parameter_table()[i].name);
    OrderedJson row = OrderedJson::array();
    for (const std::size_t j : present)
      row.push_back(c.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    matrix.push_back(row);
  }
  return {{"names", names}, {"matrix", matrix}};
}

OrderedJson scatter_to_json(const fit::PackingScatter& scatter) {
  return {{"packings", scatter.packings},
          {"degrees_of_freedom", scatter.degrees_of_freedom},
          {"compression", number_or_null(scatter.compression)},
          {"s_par", number_or_null(scatter.s_par)},
          {"F_par", number_or_null(scatter.F_par)}};
}

fit::PackingScatter scatter_from_json(const Json& object) {
  return {object["packings"], object["degrees_of_freedom"], number_or_nan(object["compression"]),
          number_or_nan(object["s_par"]), number_or_nan(object["F_par"])};
}

constexpr int kVersion = 4;

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

/// True for the alpha of an Eq. (20) whose Q_c is zero: the law does not depend on it.
bool without_exponential(const fit::Calibration& calibration, std::size_t alpha) {
  const ParameterInfo& info = parameter_table()[alpha];
  const std::string name = info.name, group = name.substr(0, name.find('.'));
  if (info.equation != std::string("20")) return false;
  const std::size_t Q_c = parameter_index(group + ".Q_c");
  return calibration.estimates[Q_c].status != fit::Status::not_identified && *fields(calibration.parameters)[Q_c] == 0;
}

}  // namespace

void write_parameters(const std::filesystem::path& file, const ParametersFile& parameters) {
  const fit::Calibration& c = parameters.calibration;
  const auto values = fields(c.parameters);
  OrderedJson document;
  document["format"] = "grainlaw parameters";
  document["format_version"] = kVersion;
  document["coupling"] = to_string(c.coupling);
  document["converged"] = c.converged;
  OrderedJson& table = document["parameters"] = OrderedJson::object();
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const fit::Estimate& estimate = c.estimates[i];
    OrderedJson entry = estimate_to_json(estimate);
    // the law's own value, so that what is predicted is what was fitted
    if (estimate.status != fit::Status::not_identified) entry["value"] = *values[i];
    entry["symbol"] = info.symbol;
    entry["equation"] = info.equation;
    table[info.name] = entry;
  }
  document["covariance"] = covariance_to_json(c);
  document["scatter"] = scatter_to_json(c.scatter);
  document["ranges"] = {
      {"nu", {c.nu_min, c.nu_max}}, {"eps_dev", {0.0, c.eps_dev_max}}, {"eps_vol", {0.0, c.eps_vol_max}}};
  if (!parameters.dataset_digest.empty()) document["dataset_digest"] = parameters.dataset_digest;
  if (!parameters.provenance.is_null()) document["provenance"] = OrderedJson(parameters.provenance);
  write_json(file, document);
}

ParametersFile read_parameters(const std::filesystem::path& file) {
  const std::string name = one_line(file.string(), 200);
  const Json document = read_json(file, JsonSource::own);
  check_schema(document, Schema::parameters, name);
  ParametersFile result;
  fit::Calibration& c = result.calibration;
  c.coupling = document["coupling"] == "single" ? Coupling::single : Coupling::energy;
  c.converged = document.value("converged", false);
  c.parameters = start_parameters();
  c.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    c.estimates[i] = {std::nan(""), std::nan(""), fit::Status::not_identified,
                      of_earlier_memory(document, parameter_table()[i].name)
                          ? "the file is older than the memory rung of this program"
                          : "not in the file"};
  }
  try {
    const auto values = fields(c.parameters);
    for (const auto& item : document["parameters"].items()) {
      if (of_earlier_memory(document, item.key())) continue;
      const std::size_t i = parameter_index(item.key());
      fit::Estimate& estimate = c.estimates[i];
      const ParameterInfo& info = parameter_table()[i];
      try {
        estimate = estimate_from_json(item.value());
      } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("parameters.{}.{}", info.name, error.what()));
      }
      if (estimate.status == fit::Status::not_identified) continue;
      if (!(estimate.value >= info.lower && estimate.value <= info.upper)) {
        throw InvalidInput(fmt::format("parameters.{}.value: {} is outside its bounds [{}, {}]", info.name,
                                       estimate.value, info.lower, info.upper));
      }
      *values[i] = estimate.value;
    }
    if (document.contains("covariance")) read_covariance(document, c.covariance);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
  if (document.contains("scatter")) c.scatter = scatter_from_json(document["scatter"]);
  const Json& ranges = document["ranges"];
  c.nu_min = ranges["nu"][0];
  c.nu_max = ranges["nu"][1];
  c.eps_dev_max = ranges["eps_dev"][1];
  c.eps_vol_max = ranges["eps_vol"][1];
  result.dataset_digest = document.value("dataset_digest", "");
  result.provenance = document.value("provenance", Json());
  return result;
}

std::optional<std::size_t> missing_parameter(const fit::Calibration& calibration, Rung model) {
  std::vector<std::string> needed;
  for (const char* group : {"coordination", "rattlers", "pressure", "shear.nu_c", "stress_ratio_max", "stress_rate",
                            "fabric_max", "fabric_rate"}) {
    needed.emplace_back(group);
  }
  if (model == Rung::memory) {
    for (const char* group : {"steady_coordination", "steady_rattlers", "steady_pressure", "memory"})
      needed.emplace_back(group);
  }
  if (model != Rung::reduced) {
    needed.emplace_back(calibration.coupling == Coupling::single ? "anisotropy.a0" : "anisotropy.a2");
  }
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string parameter = parameter_table()[i].name;
    for (const std::string& group : needed) {
      if (parameter != group && !parameter.starts_with(group + ".")) continue;
      const bool read = !parameter.ends_with(".alpha") || !without_exponential(calibration, i);
      if (read && calibration.estimates[i].status == fit::Status::not_identified) return i;
    }
  }
  return std::nullopt;
}

void require_parameters(const ParametersFile& parameters, Rung model, const std::string& name) {
  const auto missing = missing_parameter(parameters.calibration, model);
  if (!missing) return;
  const std::string& note = parameters.calibration.estimates[*missing].note;
  throw InvalidInput(fmt::format(
      "{}: parameters.{}: is not identified and the {} model needs it{}{}; calibrate with tests that contain "
      "it",
      name, parameter_table()[*missing].name, to_string(model), note.empty() ? "" : ": ", note));
}

}  // namespace grainlaw::chain
