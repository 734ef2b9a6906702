#include "chain/studies/calibrated_setting.hpp"

#include <fmt/format.h>

#include <set>

#include "chain/studies/law_quantities.hpp"
#include "fit/calibrate.hpp"
#include "model/files/path_file.hpp"
#include "model/files/execution.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {

std::vector<double> shear_densities(const Dataset& dataset) {
  std::set<double> densities;
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == Role::calibration && is_pure_shear(test.record)) densities.insert(test.record.path.nu);
  }
  return {densities.begin(), densities.end()};
}

Path study_path(const std::filesystem::path& file) {
  const PathFile path = read_path(file);
  if (law_decides(path.path))
    throw InvalidInput(
        fmt::format("{}: segments: leave the strain to the law; a study needs a path of given strain", file.string()));
  return path.path;
}

SettingOutcome calibrated_setting(const std::string& name, const Changes& changes, const Dataset& dataset,
                                  const fit::CalibrationOptions& options, const std::vector<double>& densities,
                                  const std::optional<Path>& path, const Execution& execution) {
  const std::vector<TestRecord> tests = tests_of(dataset, Role::calibration);
  SettingOutcome outcome{name, changes, cost_of(dataset), packings_of(dataset), {}, {}, energy_residual_of(dataset),
                         "",   ""};
  execution.watch.begin({1}, "");
  const RunControl control = execution.watch.control(0, "fit of " + name, execution.stop);
  const Stopwatch stopwatch;
  try {
    const fit::Calibration calibration = fit::calibrate(tests, options, control);
    outcome.cost.fit_seconds = stopwatch.seconds();
    if (!calibration.law.converged) outcome.note = "the fit did not converge";
    outcome.quantities = law_quantities(calibration, densities, outcome.seeds.size());
    if (path) {
      for (StudyQuantity& quantity : outcome.quantities) quantity.in_error = false;
      require_parameters(calibration.law, Rung::reduced, "calibration");
      const Rung rung = richest_rung(calibration.law).value();
      const auto predicted = predicted_quantities(calibration, *path, rung, outcome.seeds.size(), control);
      outcome.quantities.insert(outcome.quantities.begin(), predicted.begin(), predicted.end());
      outcome.model = to_string(rung);
    }
  } catch (const InvalidInput& error) {
    outcome.note = error.what();
  } catch (const NotConverged& error) {
    outcome.note = error.what();
  }
  execution.watch.end();
  return outcome;
}

}  // namespace grainlaw::chain
