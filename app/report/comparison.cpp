// Two calibrations side by side.

#include <algorithm>
#include <cmath>

#include "app/report/first_screen.hpp"
#include "app/report/tables.hpp"

namespace grainlaw::app::report {
namespace {

using enum Content;
using chain::PathError;

struct Pair {
  const ParameterInfo& info;
  const Estimate &ours, &other;

  bool known() const { return ours.status != Status::not_identified && other.status != Status::not_identified; }
  /// In units of the difference's standard error; NaN where one has none: nothing is so and so many of none away.
  double distance() const {
    const bool both = known() && ours.standard_error > 0 && other.standard_error > 0;
    return both ? (ours.value - other.value) / std::hypot(ours.standard_error, other.standard_error) : kUndefined;
  }
};

struct OnPath {
  const PathError &ours, &other;
};

}  // namespace

Table parameter_pairs(const CalibratedLaw& ours, const CalibratedLaw& other) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const Pair pair{parameter_table()[i], ours.estimates[i], other.estimates[i]};
    if (pair.ours.status != Status::not_identified || pair.other.status != Status::not_identified)
      pairs.push_back(pair);
  }
  const auto beyond = std::ranges::count_if(pairs, [](const Pair& pair) { return std::abs(pair.distance()) > 2; });
  const auto judged = std::ranges::count_if(pairs, [](const Pair& pair) { return std::isfinite(pair.distance()); });
  return table_of(std::to_string(beyond) + " of " + std::to_string(judged) +
                      " parameters that have an error in both differ by more than twice the standard error of the "
                      "difference. Errors count as "
                      "independent, which those of shared packings are not",
                  "parameters.json of both", pairs,
                  {{"parameter", words, [](auto& pair) { return pair.info.name; }},
                   {"this", number, [](auto& pair) { return estimate_cell(pair.ours); }},
                   {"other", number, [](auto& pair) { return estimate_cell(pair.other); }},
                   {"difference [errors]", number, [](auto& pair) { return decimals(pair.distance(), 1); }},
                   {"difference", number, [](auto& pair) {
                      return pair.known() ? difference_cell(pair.ours.value, pair.other.value) : Cell(kNoNumber);
                    }}});
}

Table error_pairs(const std::vector<PathError>& ours, const std::vector<PathError>& other) {
  std::vector<OnPath> common;
  for (const PathError& mine : ours) {
    if (!mine.recommended) continue;
    const auto along = [&](const PathError& entry) {
      return entry.recommended && same_path(*entry.along, *mine.along);
    };
    auto theirs =
        std::ranges::find_if(other, [&](const PathError& entry) { return entry.path == mine.path && along(entry); });
    if (theirs == other.end()) theirs = std::ranges::find_if(other, along);
    if (theirs != other.end()) common.push_back({mine, *theirs});
  }
  const auto column = [](std::size_t q, bool mine) {
    return [=](const OnPath& path) {
      const double error = (mine ? path.ours : path.other).error[q];
      return Cell(fixed(100 * error, 1), 100 * error, heat_of(error));
    };
  };
  return table_of("Errors on the paths that both have, each by the rung that it recommends [%]: this, other",
                  "comparison.json, parameters.json of both", common,
                  {{"path", words, [](auto& path) { return path.ours.path; }},
                   {"rung", words, [](auto& path) { return to_string(path.ours.rung); }},
                   {"other's", words, [](auto& path) { return to_string(path.other.rung); }},
                   {"{P}*", number, column(0, true)},
                   {"other", number, column(0, false)},
                   {"{s}", number, column(1, true)},
                   {"other", number, column(1, false)},
                   {"{F}", number, column(2, true)},
                   {"other", number, column(2, false)}});
}

}  // namespace grainlaw::app::report
