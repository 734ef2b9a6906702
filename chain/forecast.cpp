#include "chain/forecast.hpp"

#include <fmt/format.h>

#include <cmath>

#include "chain/planning/planned_spec.hpp"
#include "chain/rehearsals.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

// What the fit of one row costs, in particle-steps: both are plain arithmetic, so that their times go together. Measured on
// fits of 6420 to 154080 rows, within a factor of 2.
constexpr double kFittedRow = 14000;
constexpr double kLammps = 12;  // time of a particle-step of LAMMPS on one core over that of our engine

PathTraits covered_by(const std::vector<const Path*>& paths) {
  std::optional<PathTraits> all;
  for (const Path* path : paths) {
    if (path->segments.empty()) continue;
    const PathTraits traits = traits_of(resolve(*path));
    all = all ? both(*all, traits) : traits;
  }
  return all.value_or(PathTraits{});
}

/// Of runs that cost this and the fit of `rows`; `like` is what the rate is measured on.
Forecast forecast_of(const dem::ExpectedCost& cost, double rows, const dem::PreparationOptions& like,
                     const Execution& execution) {
  Forecast forecast;
  forecast.cost = cost;
  const double work = cost.particle_steps;
  forecast.rate = std::nan("");
  if (work == 0 && rows == 0) return forecast;
  forecast.rate = dem::measured_rate(like, execution.threads, execution.stop);
  if (!(forecast.rate > 0)) {
    forecast.rate = forecast.run_seconds = forecast.fit_seconds = std::nan("");
    forecast.notes.emplace_back(
        "how long it takes could not be measured: a packing of this kind does not run as it is");
    return forecast;
  }
  forecast.run_seconds = work / forecast.rate;
  if (like.choice.is_lammps()) {
    forecast.run_seconds *= kLammps;
    forecast.notes.push_back(
        fmt::format("LAMMPS is taken to be {:g} times as slow as our engine, without a launcher", kLammps));
  }
  forecast.fit_seconds = rows * kFittedRow / forecast.rate;
  return forecast;
}

double fitted_rows(const std::vector<dem::PlannedTest>& tests) {
  double rows = 0;
  for (const dem::PlannedTest& test : tests) {
    if (test.role == Role::calibration) rows += static_cast<double>(test.path.segments.size()) * test.rows;
  }
  return rows;
}

/// Of `tests` as they would be run, and their fit where `fitted`.
Forecast forecast_of(const std::vector<dem::PlannedTest>& tests, bool fitted, const dem::PreparationOptions& like,
                     const fs::path& output, const Execution& execution) {
  Forecast forecast = forecast_of(dem::expected_cost(tests, output), fitted ? fitted_rows(tests) : 0, like, execution);
  std::vector<const Path*> paths;
  for (const dem::PlannedTest& test : tests) paths.push_back(&test.path);
  forecast.covers = covered_by(paths);
  return forecast;
}

/// Of a calibration, which is refused where it would be.
Forecast forecast_of(const dem::Spec& spec, const fs::path& output, const Execution& execution) {
  require_rehearsals_of(packing_of(spec), output / "dataset");
  return forecast_of(plan(spec), true, spec.preparation, output, execution);
}

void note_beyond(const PathTraits& path, const ValidRange& range, std::vector<std::string>& notes) {
  constexpr double kSlack = 1e-6;
  const auto note = [&](const char* what, double value, double limit) {
    notes.push_back(fmt::format("{} {:.4g} lies beyond the calibrated {:.4g}", what, value, limit));
  };
  if (path.nu_min < range.nu_min - kSlack) note("volume fraction", path.nu_min, range.nu_min);
  if (path.nu_max > range.nu_max + kSlack) note("volume fraction", path.nu_max, range.nu_max);
  if (path.eps_dev > range.eps_dev_max + kSlack) note("deviatoric strain", path.eps_dev, range.eps_dev_max);
  if (path.shear_path > range.shear_path_max + kSlack) note("shear path", path.shear_path, range.shear_path_max);
}

}  // namespace

Forecast forecast(const CalibrationInput& input, const fs::path& output, const Execution& execution) {
  if (!input.dataset) return forecast_of(*input.spec, output, execution);
  double rows = 0, bytes = 0;
  std::vector<const Path*> paths;
  for (const DatasetTest& test : input.dataset->tests) {
    paths.push_back(&test.record.path);
    std::error_code unknown;
    const auto size = fs::file_size(input.dataset_folder / (test.record.name + ".csv"), unknown);
    if (!unknown) bytes += static_cast<double>(size);
    if (test.record.role == Role::calibration) rows += static_cast<double>(test.record.rows.size());
  }
  Forecast fit = forecast_of({.bytes = bytes}, rows, {}, execution);
  fit.covers = covered_by(paths);
  return fit;
}

Forecast forecast_of_pilot(const PrecisionTarget& target, const dem::Spec& frame, const std::string& name,
                           const fs::path& output, const Execution& execution) {
  const dem::Spec pilot = rounds_of(planned_spec(frame, pilot_settings(frame, name), target.path));
  Forecast forecast = forecast_of(pilot, output, execution);
  forecast.notes.emplace_back("this is the pilot alone; what the plan takes follows from what it shows");
  return forecast;
}

Forecast forecast(const dem::TestFile& test, const fs::path& output, const Execution& execution) {
  dem::PreparationOptions like = test.preparation;
  if (test.given) like.packing.particles = static_cast<std::int64_t>(test.given->packing.size());
  Forecast forecast = forecast_of(dem::expected_cost(test, output), 0, like, execution);
  forecast.covers = covered_by({&test.path});
  return forecast;
}

Forecast forecast(const PredictionInput& input, const Execution& execution) {
  Forecast forecast;
  const Path& path = input.path.path;
  if (input.new_runs) {
    const NewRuns& runs = *input.new_runs;
    const auto seeds = dem::new_seeds(runs.spec, input.path, runs.seeds, runs.fitted, input.path_name);
    forecast = forecast_of(plan(runs.spec, input.path, seeds, input.path_name), false, runs.spec.preparation,
                           runs.store, execution);
  }
  if (law_decides(path)) {
    forecast.notes.emplace_back("the law decides where the path leads; prediction.json says");
    return forecast;
  }
  forecast.covers = traits_of(resolve(path));
  note_beyond(forecast.covers, input.law.range, forecast.notes);
  return forecast;
}

}  // namespace grainlaw::chain
