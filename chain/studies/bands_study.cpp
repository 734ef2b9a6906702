#include "chain/studies/bands_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "chain/rehearsals.hpp"
#include "model/files/fields_json.hpp"
#include "model/parameters_file.hpp"
#include "model/student.hpp"
#include "model/vocabulary/error.hpp"
#include "predict/bands.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

double half(const predict::Variance& variance) {
  return variance.value > 0 ? student_95(variance.degrees_of_freedom) * std::sqrt(variance.value) : 0;
}

/// `rows` against the band that `error` gives; only the shares, bias, its error and rms are set.
BandCoverage coverage_of(const predict::RehearsedRows& rows, Rehearsed quantity, const LawError& error,
                         const PackingScatter& scatter) {
  BandCoverage coverage;
  const double t = scatter.degrees_of_freedom > 0 ? student_95(scatter.degrees_of_freedom) : 0;
  double within = 0, within_without = 0, within_single = 0, singles = 0, squares = 0, sum = 0, errors = 0, largest = 0;
  for (const auto& values : rows) {
    const predict::RehearsedValue& value = values[static_cast<std::size_t>(quantity)];
    if (value.differences.empty()) continue;
    const double n = static_cast<double>(value.differences.size()), own = t * std::sqrt(value.mean_variance);
    const predict::Variance known{value.variance, value.degrees_of_freedom};
    const double without = half(known), d = value.mean_difference(), w = value.weight,
                 band = half(predict::widened(known, std::pow(w * error.tau, 2), error.degrees_of_freedom));
    ++coverage.rows;
    within += std::abs(d) <= std::hypot(band, own);
    within_without += std::abs(d) <= std::hypot(without, own);
    for (const double single : value.differences)
      within_single += std::abs(single) <= std::hypot(band, own * std::sqrt(n));
    singles += n;
    sum += d / w;
    errors += std::sqrt(value.variance + value.mean_variance) / w;
    squares += d * d / (w * w);
    largest = std::max(largest, std::abs(d / w));
  }
  coverage.bias = sum / coverage.rows;
  coverage.bias_error = errors / coverage.rows;
  coverage.rms = std::sqrt(squares / coverage.rows);
  coverage.without = within_without / coverage.rows;
  coverage.mean = within / coverage.rows;
  coverage.single = within_single / singles;
  coverage.whole = largest <= error.largest;
  return coverage;
}

CoverageSummary summary_of(const std::vector<BandCoverage>& coverages, Rung model, Rehearsed quantity) {
  CoverageSummary summary{model, quantity};
  for (const BandCoverage& c : coverages) {
    if (c.model != model || c.quantity != quantity) continue;
    ++summary.paths;
    summary.without += c.without;
    summary.mean += c.mean;
    summary.single += c.single;
    summary.least_mean = std::min(summary.least_mean, c.mean);
    summary.least_single = std::min(summary.least_single, c.single);
    summary.whole += c.whole;
    summary.promised_whole += c.degrees_of_freedom / (c.degrees_of_freedom + 1);
  }
  for (double* share : {&summary.without, &summary.mean, &summary.single, &summary.whole, &summary.promised_whole})
    *share /= summary.paths;
  return summary;
}

}  // namespace

BandsStudy study_bands(const fs::path& folder, const std::vector<fs::path>& more, const Execution& execution) {
  BandsStudy study{(folder / "parameters.json").string(), {}, {}};
  CalibratedLaw law = read_parameters(folder / "parameters.json").law;
  std::vector<predict::RehearsalRuns> paths;
  const bool has_data = fs::exists(folder / "dataset" / "dataset.json");
  const Dataset fitted = has_data ? read_dataset(folder / "dataset") : Dataset{};
  if (has_data) paths = rehearsals_of(fitted, folder / "dataset");
  for (const fs::path& given : more) {
    const fs::path plain = given.has_filename() ? given : given.parent_path();
    for (predict::RehearsalRuns& path : read_rehearsals(given, plain.filename().string(), &fitted))
      paths.push_back(std::move(path));
  }
  if (paths.size() < 2) {
    throw InvalidInput(fmt::format("{}: has {} rehearsals; two paths or more are left out in turn, give --runs",
                                   folder.string(), paths.size()));
  }
  std::map<std::string, int> times;  // records are found by names, and two folders may be called alike
  for (predict::RehearsalRuns& path : paths) {
    if (const int n = ++times[path.name]; n > 1) path.name += fmt::format("-{}", n);
  }
  rehearse(law, paths, execution);
  for (const Rung rung : calibrated_rungs(law)) {
    for (const Rehearsal& record : law.rehearsals) {
      const auto runs = std::ranges::find(paths, record.name, &predict::RehearsalRuns::name);
      const auto followed = std::ranges::find(record.rungs, rung, &RehearsedRung::rung);
      if (followed == record.rungs.end()) continue;
      const predict::RehearsedRows rows = predict::rehearse(law, rung, *runs, {{}, execution.stop});
      const Spokesmen others = spokesmen_for(resolve(record.path), law.rehearsals);
      for (const Rehearsed quantity : kValues<Rehearsed>) {
        const LawError error = law_error(others, rung, quantity);
        if (followed->of(quantity).rows == 0 || error.degrees_of_freedom == 0) continue;
        BandCoverage coverage = coverage_of(rows, quantity, error, law.scatter);
        coverage.path = record.name;
        coverage.kind = record.kind;
        coverage.packings = record.packings;
        coverage.model = rung;
        coverage.quantity = quantity;
        coverage.of_kind = others.of_kind;
        coverage.degrees_of_freedom = error.degrees_of_freedom;
        coverage.tau = error.tau;
        study.coverages.push_back(coverage);
      }
    }
    for (const Rehearsed quantity : kValues<Rehearsed>) {
      CoverageSummary summary = summary_of(study.coverages, rung, quantity);
      if (summary.paths > 0) study.summaries.push_back(summary);
    }
  }
  return study;
}

OrderedJson study_to_json(const BandsStudy& study) {
  return {{"format", "grainlaw study"},
          {"format_version", 1},
          {"study", "bands"},
          {"parameters", study.parameters},
          {"summaries", fields_to_json(study.summaries)},
          {"coverages", fields_to_json(study.coverages)}};
}

}  // namespace grainlaw::chain
