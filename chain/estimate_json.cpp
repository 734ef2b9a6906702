#include "chain/estimate_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

/// Of files without the key, older ones: infinite, as if errors were exact.
double degrees_of_freedom(const Json& object) {
  if (object.contains("degrees_of_freedom")) return number_or_nan(object["degrees_of_freedom"]);
  return object.at("standard_error").is_null() ? std::nan("") : std::numeric_limits<double>::infinity();
}

}  // namespace

OrderedJson estimate_to_json(const fit::Estimate& estimate) {
  const bool has_value = estimate.status != fit::Status::not_identified;
  OrderedJson object;
  object["value"] = has_value ? number_or_null(estimate.value) : OrderedJson(nullptr);
  object["standard_error"] = has_value ? number_or_null(estimate.standard_error) : OrderedJson(nullptr);
  object["degrees_of_freedom"] = has_value ? number_or_null(estimate.degrees_of_freedom) : OrderedJson(nullptr);
  const double half = has_value ? estimate.half_width() : std::nan("");
  if (std::isfinite(half)) object["interval_95"] = {estimate.value - half, estimate.value + half};
  object["status"] = to_string(estimate.status);
  if (!estimate.note.empty()) object["note"] = estimate.note;
  return object;
}

fit::Estimate estimate_from_json(const Json& object) {
  fit::Estimate estimate{number_or_nan(object.at("value")), number_or_nan(object.at("standard_error")),
                         value_of<fit::Status>(object.at("status").get<std::string>(), "status"),
                         object.value("note", ""), degrees_of_freedom(object)};
  if ((estimate.status == fit::Status::not_identified) != std::isnan(estimate.value)) {
    throw InvalidInput(
        fmt::format("value: must be null exactly when the status is '{}'", to_string(fit::Status::not_identified)));
  }
  return estimate;
}

}  // namespace grainlaw::chain
