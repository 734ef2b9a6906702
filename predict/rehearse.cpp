#include "predict/rehearse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/vocabulary/error.hpp"
#include "predict/bands.hpp"
#include "predict/compare.hpp"

namespace grainlaw::predict {
namespace {

constexpr double kSameRow = 1e-3;  // of strain; runs of one path record a row within a time step of its strain

void check_runs(const RehearsalRuns& runs) {
  if (runs.runs.empty() || runs.runs.front().rows.empty())
    throw InvalidInput(fmt::format("rehearsal {}: has no run with rows", runs.name));
  const TestRecord& first = runs.runs.front();
  for (const TestRecord& run : runs.runs) {
    bool same = run.rows.size() == first.rows.size();
    for (std::size_t i = 0; same && i < run.rows.size(); ++i)
      same = (run.rows[i].strain.tensor - first.rows[i].strain.tensor).norm() <= kSameRow;
    if (same) continue;
    throw InvalidInput(
        fmt::format("rehearsal {}: {} and {} have no rows at the same strains; a rehearsal is runs of one path",
                    runs.name, first.name, run.name));
  }
}

}  // namespace

double RehearsedValue::mean_difference() const {
  double sum = 0;
  for (const double difference : differences) sum += difference;
  return sum / static_cast<double>(differences.size());
}

RehearsedRows rehearse(const CalibratedLaw& law, Rung rung, const RehearsalRuns& runs, const RunControl& control) {
  check_runs(runs);
  const TestRecord& first = runs.runs.front();
  const auto segments = resolve(first.path);
  const LawState<double> start = state_from_law(law.parameters, first.path.nu);
  const auto along = [&](const TestRecord& run, const Sensitivity& sensitivity) {
    return predict(rung, law.parameters, law.coupling, segments, start, points_of(run), {}, law.range, control,
                   sensitivity);
  };
  // each run at its own strains; the slopes, which take most of the time, at the first one's
  const BandMaker bands(law);
  std::vector<std::array<Variance, 3>> known;  // of the rows
  const auto judge = [&](const PredictedRow&, const std::vector<RowSlope>& slopes) {
    auto& variances = known.emplace_back();
    for (const Rehearsed quantity : kValues<Rehearsed>)
      variances[static_cast<std::size_t>(quantity)] =
          bands.of_law(slopes, kComparedQuantities[static_cast<std::size_t>(quantity)].slope);
  };
  const Prediction prediction = along(first, {uncertain_parameters(law), true, judge});
  std::vector<Prediction> of_runs{prediction};
  for (std::size_t r = 1; r < runs.runs.size(); ++r) of_runs.push_back(along(runs.runs[r], {}));
  const double from = counts_from(segments);
  RehearsedRows rows;
  for (std::size_t i = 0; i < prediction.rows.size(); ++i) {
    const PredictedRow& row = prediction.rows[i];
    if (row.shear_path < from) continue;
    const ErrorUnits units = error_units(law.parameters, row.nu);
    auto& values = rows.emplace_back();
    for (const Rehearsed quantity : kValues<Rehearsed>) {
      const auto q = static_cast<std::size_t>(quantity);
      RehearsedValue& value = values[q];
      value.weight = units.of(quantity);
      const Variance of_law = known.empty() ? Variance{} : known[i][q];
      value.variance = of_law.value;
      value.degrees_of_freedom = of_law.degrees_of_freedom;
      const double scatter = bands.scatter(row.nu, quantity);
      value.mean_variance = std::isfinite(scatter) ? scatter * scatter / static_cast<double>(runs.runs.size()) : 0;
      for (std::size_t r = 0; r < runs.runs.size(); ++r) {
        value.differences.push_back(runs.runs[r].rows[i].*kComparedQuantities[q].measured -
                                    kComparedQuantities[q].predicted(of_runs[r].rows[i]));
      }
      // slopes end where the place of an event moves: what is behind is the law's error, none of which is put down to chance
      if (!std::isfinite(value.variance)) value.variance = value.degrees_of_freedom = 0;
      const bool defined =
          value.weight > 0 && std::ranges::all_of(value.differences, [](double d) { return std::isfinite(d); });
      if (!defined) value.differences.clear();
    }
  }
  return rows;
}

RehearsedQuantity summary_of(const RehearsedRows& rows, Rehearsed quantity, bool fitted_packings) {
  RehearsedQuantity summary;
  for (const auto& values : rows) {
    const RehearsedValue& value = values[static_cast<std::size_t>(quantity)];
    if (value.differences.empty()) continue;
    const double scaled = value.mean_difference() / value.weight;
    ++summary.rows;
    summary.square += scaled * scaled;
    // what packings do to the law and to the runs is not independent on the same packings: nothing is taken off
    if (!fitted_packings) summary.known += (value.variance + value.mean_variance) / (value.weight * value.weight);
    summary.largest = std::max(summary.largest, std::abs(scaled));
  }
  if (summary.rows > 0) {
    summary.square /= summary.rows;
    summary.known /= summary.rows;
  }
  return summary;
}

Rehearsal rehearsal_of(const CalibratedLaw& law, const std::vector<Rung>& rungs, const RehearsalRuns& runs,
                       const RunControl& control, std::vector<std::string>& failures) {
  check_runs(runs);
  Rehearsal rehearsal;
  rehearsal.name = runs.name;
  rehearsal.path = runs.runs.front().path;
  rehearsal.traits = traits_of(resolve(rehearsal.path));
  rehearsal.kind = kind_of(rehearsal.traits);
  rehearsal.packings = static_cast<int>(runs.runs.size());
  for (const Rung rung : rungs) {
    try {
      const RehearsedRows rows = rehearse(law, rung, runs, control);
      rehearsal.rungs.push_back({rung, summary_of(rows, Rehearsed::P_star, runs.fitted_packings),
                                 summary_of(rows, Rehearsed::s_par, runs.fitted_packings),
                                 summary_of(rows, Rehearsed::F_par, runs.fitted_packings)});
    } catch (const NotConverged& error) {
      failures.push_back(fmt::format("rehearsal {}: {} is left out: {}", runs.name, to_string(rung), error.what()));
    }
  }
  return rehearsal;
}

}  // namespace grainlaw::predict
