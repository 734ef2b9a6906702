#include "app/files/estimate_json.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "model/error.hpp"

namespace grainlaw::app {
namespace {

constexpr std::array kStatuses{fit::Status::fitted, fit::Status::fixed, fit::Status::tied, fit::Status::at_bound,
                               fit::Status::not_identified};

fit::Status status_from(const std::string& text) {
  for (const fit::Status status : kStatuses) {
    if (to_string(status) == text) return status;
  }
  throw InvalidInput(fmt::format("status: '{}' is not known", text));
}

}  // namespace

OrderedJson estimate_to_json(const fit::Estimate& estimate) {
  const bool has_value = estimate.status != fit::Status::not_identified;
  OrderedJson object;
  object["value"] = has_value ? number_or_null(estimate.value) : OrderedJson(nullptr);
  object["standard_error"] = has_value ? number_or_null(estimate.standard_error) : OrderedJson(nullptr);
  object["status"] = to_string(estimate.status);
  if (!estimate.note.empty()) object["note"] = estimate.note;
  return object;
}

fit::Estimate estimate_from_json(const Json& object) {
  fit::Estimate estimate{number_or_nan(object.at("value")), number_or_nan(object.at("standard_error")),
                         status_from(object.at("status")), object.value("note", "")};
  if ((estimate.status == fit::Status::not_identified) != std::isnan(estimate.value)) {
    throw InvalidInput(
        fmt::format("value: must be null exactly when the status is '{}'", to_string(fit::Status::not_identified)));
  }
  return estimate;
}

}  // namespace grainlaw::app
