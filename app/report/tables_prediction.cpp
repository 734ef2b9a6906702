// Predictions against DEM, and what their integration took.

#include <algorithm>
#include <cmath>

#include "app/report/figures.hpp"
#include "app/report/first_screen.hpp"
#include "app/report/tables.hpp"

namespace grainlaw::app::report {
namespace {

using enum Content;
using predict::CurveComparison, predict::PredictionFolder;

Cell seed_or(const std::optional<std::uint64_t>& seed, const char* words) { return seed ? Cell(*seed) : Cell(words); }

}  // namespace

Table unseen_table(const std::vector<chain::PathError>& errors, bool predicted,
                   const std::vector<PredictionFolder>& predictions) {
  std::vector<chain::PathError> shown;
  std::copy_if(errors.begin(), errors.end(), std::back_inserter(shown),
               [=](const chain::PathError& e) { return (e.prediction != nullptr) == predicted; });
  const auto link = [&](const chain::PathError& e) {
    return predicted ? prediction_id(static_cast<std::size_t>(e.prediction - predictions.data())) : std::string();
  };
  const auto cell = [&](std::size_t q) {
    return [=](const chain::PathError& e) {
      std::string words = fixed(100 * e.error[q], 1);
      if (std::isfinite(e.in_band[q])) words += " (" + fixed(100 * e.in_band[q], 0) + ")";
      Cell shade(words, 100 * e.error[q], heat_of(e.error[q]));
      shade.link = link(e);
      return shade;
    };
  };
  Table table = table_of(
      predicted ? "Predicted paths: error, RMS over max|DEM|, mean of the runs' own [%]; in brackets the "
                  "share of rows of single runs within their 95 % band [%]"
                : "Rehearsed paths, which no fit saw either: error, RMS over the largest value of the law, to "
                  "first order [%]",
      predicted ? "predictions/*/comparison.json" : "parameters.json", shown,
      {{"path", words,
        [&](const chain::PathError& e) {
          Cell path(predicted ? e.path : e.path + " (" + to_string(e.kind) + ")");
          path.link = link(e);
          return path;
        }},
       {"rung", words, [](const chain::PathError& e) { return to_string(e.rung) + (e.recommended ? " ★" : ""); }},
       {"{P}*", number, cell(0)},
       {"{s}", number, cell(1)},
       {"{F}", number, cell(2)}});
  table.id = predicted ? "unseen" : "rehearsed";
  return table;
}

Table prediction_table(const PredictionFolder& prediction) {
  const auto quantities = each_within(
      prediction.comparisons, [](const CurveComparison& entry) -> auto& { return entry.comparison.quantities; });
  return table_of(prediction.name + ": prediction minus DEM, run by run",
                  "predictions/" + prediction.name + "/comparison.json", quantities,
                  {{"model", words, [](auto& q) { return to_string(q.in.model); }},
                   {"start", words, [](auto& q) { return to_string(q.in.initial); }},
                   {"DEM seed", number, [](auto& q) { return seed_or(q.in.seed, "mean"); }},
                   {"quantity", words, [](auto& q) { return q.it.quantity; }},
                   {"rows", number, [](auto& q) { return q.it.rows; }},
                   {"bias", number, [](auto& q) { return digits(q.it.bias, 3); }},
                   {"RMS", number, [](auto& q) { return digits(q.it.rms, 3); }},
                   {"RMS/max|DEM| [%]", number, [](auto& q) { return decimals(100 * q.it.normalised_rms, 2); }},
                   {"largest", number, [](auto& q) { return digits(q.it.largest, 3); }},
                   {"at {ε}_{dev}", number, [](auto& q) { return digits(q.it.largest_at_eps_dev, 3); }},
                   {"at {ν}", number, [](auto& q) { return decimals(q.it.largest_at_nu, 3); }},
                   {"in band of the mean [%]", number, [](auto& q) { return decimals(100 * q.it.coverage_mean, 0); }},
                   {"of a single run [%]", number, [](auto& q) { return decimals(100 * q.it.coverage_single, 0); }}});
}

Table solver_table(const std::vector<PredictionFolder>& predictions) {
  const auto curves = each_within(predictions, &PredictionFolder::curves);
  const auto statistics = [](const auto& curve) -> const predict::SolverStatistics& {
    return curve.it.prediction.statistics;
  };
  return table_of("What the integration of the law took", "predictions/*/prediction.json", curves,
                  {{"path", words, [](auto& curve) { return curve.in.name; }},
                   {"model", words, [](auto& curve) { return to_string(curve.it.model); }},
                   {"start", words, [](auto& curve) { return to_string(curve.it.initial); }},
                   {"DEM seed", number, [](auto& curve) { return seed_or(curve.it.seed, kNoNumber); }},
                   {"rows", number, [](auto& curve) { return curve.it.prediction.rows.size(); }},
                   {"steps", number, [=](auto& curve) { return statistics(curve).steps; }},
                   {"right-hand sides", number, [=](auto& curve) { return statistics(curve).rhs_evaluations; }},
                   {"failed error tests", number, [=](auto& curve) { return statistics(curve).error_test_failures; }},
                   {"restarts", number, [=](auto& curve) { return statistics(curve).restarts; }},
                   {"seconds", number, [=](auto& curve) { return digits(statistics(curve).seconds, 2); }}});
}

}  // namespace grainlaw::app::report
