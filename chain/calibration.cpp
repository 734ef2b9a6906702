#include "chain/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "chain/fitted_paths.hpp"
#include "chain/rehearsals.hpp"
#include "dem/runs/pictures.hpp"
#include "fit/calibration_file.hpp"
#include "fit/describe.hpp"
#include "fit/leave_one_out.hpp"
#include "fit/prior_file.hpp"
#include "fit/published/verdicts.hpp"
#include "model/files/dataset.hpp"
#include "model/files/output.hpp"
#include "model/files/reading.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

/// Parameters of another spec must not stay beside this one's data, should the work be interrupted.
void remove_results_of_others(const fs::path& output, const std::string& spec) {
  const fs::path resolved = output / "spec.resolved.json";
  if ((fs::exists(resolved) ? read_bytes(resolved) : "") == spec) return;
  for (const char* name : {"parameters.json", "calibration.json", "fitted_paths.json"}) fs::remove(output / name);
}

/// Refuses before anything runs what no fit can be made of.
void check_tests(const std::vector<TestRecord>& tests, const std::string& name) {
  const auto missing = [&](const char* what, const char* mode) {
    const auto in_parts = std::ranges::find_if(tests, [](const TestRecord& t) { return t.path.segments.size() > 1; });
    throw InvalidInput(
        fmt::format("{}: tests: none of role calibration is {}; add {{\"mode\": \"{}\", \"role\": \"calibration\"}}{}",
                    name, what, mode,
                    in_parts == tests.end() ? ""
                                            : fmt::format(", or split: such a test is one segment, {} has {}",
                                                          in_parts->name, in_parts->path.segments.size())));
  };
  if (std::none_of(tests.begin(), tests.end(), is_isotropic_unloading)) missing("an isotropic unloading", "ISO");
  if (std::none_of(tests.begin(), tests.end(), is_pure_shear)) missing("a shear at constant volume", "D2");
}

std::vector<TestRecord> calibration_tests(const std::vector<dem::PlannedTest>& planned) {
  std::vector<TestRecord> tests;
  for (const dem::PlannedTest& test : planned) {
    if (test.role == Role::calibration) tests.push_back({test.name, test.role, test.path, {}, {}});
  }
  return tests;
}

/// One line for all: dataset.json has them by test.
void log_warnings(const Dataset& dataset, Watch& watch) {
  std::size_t tests = 0;
  std::string first;
  for (const DatasetTest& test : dataset.tests) {
    if (test.warnings.empty()) continue;
    if (first.empty()) first = fmt::format("{}: {}", test.record.name, test.warnings.front());
    ++tests;
  }
  if (tests > 0)
    watch.log(fmt::format("warning: {} of {} tests have warnings (listed in dataset.json), e.g. {}", tests,
                          dataset.tests.size(), first));
}

/// Those of role description, and D3 where it is calibration beside D2: its own laws are Table 2's and Table 3's.
std::vector<TestRecord> described_tests(const Dataset& dataset) {
  const auto shears_by = [](const TestRecord& test, Mode mode) {
    return is_pure_shear(test) && test.path.segments.front().mode == mode;
  };
  std::vector<TestRecord> all = tests_of(dataset, Role::description), fitted = tests_of(dataset, Role::calibration);
  if (std::none_of(fitted.begin(), fitted.end(), [&](const TestRecord& t) { return shears_by(t, Mode::D2); }))
    return all;
  for (TestRecord& test : fitted) {
    if (!shears_by(test, Mode::D3)) continue;
    test.role = Role::description;
    all.push_back(std::move(test));
  }
  return all;
}

/// A fit and what it is compared with, in no file yet.
struct Fitted {
  fit::Calibration calibration;
  fit::ModeComparison modes;
  std::vector<FittedPath> paths;
};

/// Of the data set that was read in `folder`.
Fitted fitted(const Dataset& dataset, const fs::path& folder, const fit::CalibrationOptions& options,
              const Execution& execution) {
  Watch& watch = execution.watch;
  const double packings = static_cast<double>(dataset.seeds.size());
  // of the time that the parts take together; the other modes are fitted in closed forms alone
  watch.begin({1, options.profiles ? packings : 0, 0.02}, "");
  const auto part = [&](std::size_t which, const char* name, const auto& work) {
    auto result = work(watch.control(which, name, execution.stop));
    watch.finished(which);
    return result;
  };
  const std::vector<TestRecord> tests = tests_of(dataset, Role::calibration);
  Fitted all;
  all.calibration = part(0, "fit", [&](const RunControl& control) { return fit::calibrate(tests, options, control); });
  CalibratedLaw& law = all.calibration.law;
  law.dataset_digest = dataset.digest;
  rehearse(law, rehearsals_of(dataset, folder), execution);
  if (options.profiles)
    all.calibration.left_out = part(1, "fits without one packing", [&](const RunControl& control) {
      return fit::leave_one_out(tests, options, control);
    });
  all.modes.descriptions = part(2, "fit of the other modes", [&](const RunControl& control) {
    return fit::describe(described_tests(dataset), law.parameters.isotropic.pressure.nu_c, options, control);
  });
  all.modes.verdicts = verdicts_of(law, all.modes.descriptions, all.calibration.size.packings);
  std::vector<TestRecord> shown = tests;
  for (const TestRecord& test : tests_of(dataset, Role::description)) shown.push_back(test);
  all.modes.claims = claims_of(shown, all.calibration, all.modes.descriptions, options.steady_from);
  set_aside_other_material(all.modes, tests);
  watch.end();
  all.paths = fitted_paths(law, shown, execution);
  return all;
}

/// fitted_paths.json, calibration.json and, last, parameters.json.
void save(const Fitted& all, const fit::CalibrationOptions& options, const fs::path& output,
          const Execution& execution) {
  const OrderedJson origin = provenance(execution);
  write_fitted_paths(output / "fitted_paths.json", all.paths, origin);
  write_calibration(output / "calibration.json", all.calibration, options, all.modes, origin);
  write_parameters(output / "parameters.json", {all.calibration.law, Json(origin)});
  for (const fit::Stage& stage : all.calibration.stages) {
    if (!stage.converged)
      execution.watch.log(fmt::format("stage '{}' of the fit did not converge: {}", stage.name, stage.termination));
  }
  for (const std::string& warning : all.calibration.warnings) execution.watch.log("warning: " + warning);
}

}  // namespace

CalibrationInput read_calibration_input(const fs::path& spec, const fs::path& dataset) {
  std::optional<dem::Spec> read;
  if (!spec.empty()) read = dem::read_spec(spec);
  return calibration_input(std::move(read), spec.string(), dataset);
}

CalibrationInput calibration_input(std::optional<dem::Spec> spec, const std::string& name, const fs::path& dataset) {
  if (!spec && dataset.empty())
    throw InvalidInput("calibrate: misses SPEC.json; give it, or --dataset with the folder of a data set");
  CalibrationInput input;
  if (!dataset.empty()) {
    input.dataset_folder = dataset_folder(dataset);
    input.dataset = read_dataset(input.dataset_folder);
    check_tests(tests_of(*input.dataset, Role::calibration), input.dataset_folder.string());
  }
  if (spec) {
    input.spec = std::move(spec);
  } else if (!input.dataset->spec.is_null()) {
    input.spec = dem::spec_from_json(input.dataset->spec, (input.dataset_folder / "dataset.json").string() + ": spec");
  }
  if (!input.dataset) check_tests(calibration_tests(plan(*input.spec)), name);
  return input;
}

fit::CalibrationOptions fit_options_of(const CalibrationInput& input, const Execution& execution) {
  fit::CalibrationOptions options;
  options.threads = execution.threads;
  options.prior = fit::shipped_prior();
  if (input.spec) options.coupling = value_of<Coupling>(input.spec->coupling, "coupling");
  return options;
}

Dataset simulate_data_set(const dem::Spec& spec, const fs::path& folder, const fs::path& output,
                          const Execution& execution, dem::RunCounts& counts,
                          const std::function<void()>& before_writing, dem::MissingRuns missing) {
  const dem::RunStore store(output, "runs");
  const std::vector<dem::PlannedTest> tests = plan(spec);
  dem::make_runs(dem::runs_of(tests), store, execution, counts, missing);
  if (before_writing) before_writing();
  Dataset dataset = dem::collect_runs(tests, Json(dem::spec_to_json(spec)), folder, store, execution);
  dem::write_pictures(folder, tests, store, execution.threads);
  log_warnings(dataset, execution.watch);
  return dataset;
}

CalibrationResult calibrate(CalibrationInput input, const fit::CalibrationOptions& options, const fs::path& output,
                            const Execution& execution, dem::MissingRuns missing) {
  if (fs::exists(output)) make_output_folder(output);  // refuses what is no folder before any work
  if (input.spec) input.spec->coupling = to_string(options.coupling);
  const OrderedJson spec = input.spec ? dem::spec_to_json(*input.spec) : OrderedJson();
  std::unique_ptr<ProcessLock> writing;
  // Earlier results stay until there is something to replace them with.
  const auto replace_results = [&] {
    writing = dem::lock_results(output, execution);
    remove_results_of_others(output, input.dataset ? "" : json_text(spec));
    if (input.spec)
      write_json(output / "spec.resolved.json", spec);
    else
      fs::remove(output / "spec.resolved.json");
  };
  CalibrationResult result;
  Stopwatch stopwatch;
  Fitted all;
  if (input.dataset) {
    all = fitted(*input.dataset, input.dataset_folder, options, execution);
    result.fit_seconds = stopwatch.seconds();
    make_output_folder(output);
    const fs::path folder = make_subfolder(output, "dataset");
    replace_results();
    result.dataset = adopt(*input.dataset, input.dataset_folder, folder);
    for (const std::string& aside : adopt_rehearsals(input.dataset_folder, folder))
      execution.watch.log("warning: a rehearsal of the data set before is put aside as " + aside);
    dem::adopt_pictures(input.dataset_folder, folder);
    log_warnings(result.dataset, execution.watch);
  } else {
    if (missing == dem::MissingRuns::simulated) dem::require_engines(plan(*input.spec), output, execution);
    const fs::path folder = output / "dataset";
    require_rehearsals_of(dem::packing_of(*input.spec), folder);
    result.dataset = without_empty_folders({folder, output}, [&] {
      make_output_folder(output);
      make_subfolder(output, "dataset");
      return simulate_data_set(*input.spec, folder, output, execution, result.counts, replace_results, missing);
    });
    stopwatch = {};
    all = fitted(result.dataset, folder, options, execution);
    result.fit_seconds = stopwatch.seconds();
  }
  save(all, options, output, execution);
  result.calibration = std::move(all.calibration);
  return result;
}

}  // namespace grainlaw::chain
