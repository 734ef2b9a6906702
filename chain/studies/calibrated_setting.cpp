#include "chain/studies/calibrated_setting.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>

#include "chain/studies/law_quantities.hpp"
#include "fit/calibrate.hpp"
#include "model/files/execution.hpp"
#include "model/files/path_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

bool same_packing(const PackingInfo& a, const PackingInfo& b) {
  return a.seed == b.seed && a.particles == b.particles && a.size_width == b.size_width &&
         a.mean_radius == b.mean_radius && a.stiffness == b.stiffness;
}

bool contains_packing(const Dataset& dataset, const PackingInfo& packing) {
  return std::ranges::any_of(dataset.tests, [&](const DatasetTest& test) {
    return test.record.role == Role::calibration && same_packing(test.record.packing, packing);
  });
}

}  // namespace

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
      const Rung rung = calibrated_rungs(calibration.law).back();
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

ReferenceByPackings::ReferenceByPackings(Dataset reference, SettingOutcome whole, fit::CalibrationOptions options,
                                         std::vector<double> densities, std::optional<Path> path)
    : reference_(std::move(reference)),
      whole_(std::move(whole)),
      options_(std::move(options)),
      densities_(std::move(densities)),
      path_(std::move(path)) {}

std::vector<StudyQuantity> ReferenceByPackings::quantities(const Dataset& dataset, const Execution& execution) {
  const std::vector<std::uint64_t> seeds = packings_of(dataset);
  if (seeds == whole_.seeds) return {};
  for (const DatasetTest& test : dataset.tests) {
    if (test.record.role == Role::calibration && !contains_packing(reference_, test.record.packing)) return {};
  }
  if (!found_.contains(seeds)) {
    Dataset part = reference_;
    std::erase_if(part.tests, [&](const DatasetTest& test) {
      return !std::binary_search(seeds.begin(), seeds.end(), test.record.packing.seed);
    });
    const std::string name = fmt::format("{} by packings {}", whole_.name, fmt::join(seeds, ", "));
    found_.emplace(seeds, calibrated_setting(name, {}, part, options_, densities_, path_, execution));
  }
  const SettingOutcome& found = found_.at(seeds);
  return found.model == whole_.model ? found.quantities : std::vector<StudyQuantity>{};
}

}  // namespace grainlaw::chain
