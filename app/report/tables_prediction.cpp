// Predictions against DEM, and what their integration took.

#include <algorithm>

#include "app/report/tables.hpp"

namespace grainlaw::app::report {
namespace {

using enum Content;
using predict::CurveComparison, predict::PredictionFolder;

Cell seed_or(const std::optional<std::uint64_t>& seed, const char* words) { return seed ? Cell(*seed) : Cell(words); }

/// What `cell` reads of the quantity `name`; no number where the comparison lacks it.
template <class OfQuantity>
auto of_quantity(const char* name, const OfQuantity& cell) {
  return [=](const Within<PredictionFolder, CurveComparison>& entry) -> Cell {
    const auto& all = entry.it.comparison.quantities;
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& q) { return q.quantity == name; });
    return found == all.end() ? kNoNumber : cell(*found);
  };
}

}  // namespace

Table prediction_summary(const std::vector<PredictionFolder>& predictions) {
  const auto bias = [](const predict::QuantityComparison& q) { return Cell(significant_padded(q.bias, 2), q.bias); };
  const auto rms = [](const predict::QuantityComparison& q) { return decimals(100 * q.normalised_rms, 1); };
  const auto is_mean = [](auto& entry) { return !entry.it.seed; };
  return table_of("Prediction minus DEM, mean over seeds: bias, and RMS over max|DEM|", "predictions/*/comparison.json",
                  each_within(predictions, &PredictionFolder::comparisons, is_mean),
                  {{"path", words, [](auto& entry) { return entry.in.name; }},
                   {"model", words, [](auto& entry) { return to_string(entry.it.model); }},
                   {"start", words, [](auto& entry) { return to_string(entry.it.initial); }},
                   {"{P}* bias", number, of_quantity("P_star", bias)},
                   {"{P}* RMS [%]", number, of_quantity("P_star", rms)},
                   {"{s}_{∥} bias", number, of_quantity("s_par", bias)},
                   {"{s}_{∥} RMS [%]", number, of_quantity("s_par", rms)},
                   {"{F}_{∥} bias", number, of_quantity("F_par", bias)},
                   {"{F}_{∥} RMS [%]", number, of_quantity("F_par", rms)}});
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
