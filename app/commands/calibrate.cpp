#include "app/commands/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "app/commands/calibrate_target.hpp"
#include "app/report/report.hpp"
#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/spec_file.hpp"
#include "fit/calibrate.hpp"
#include "fit/calibration_file.hpp"
#include "fit/leave_one_out.hpp"
#include "fit/published/verdicts.hpp"
#include "model/files/adopted_dataset.hpp"
#include "model/files/dataset.hpp"
#include "model/files/output_folder.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

/// Parameters of another spec must not stay beside this one's data, should the work be interrupted.
void remove_results_of_others(const fs::path& output, const std::string& spec) {
  std::ifstream file(output / "spec.resolved.json", std::ios::binary);
  if (std::string{std::istreambuf_iterator<char>(file), {}} == spec) return;
  for (const char* name : {"parameters.json", "calibration.json"}) fs::remove(output / name);
}

/// Refuses before anything runs what no fit can be made of.
void check_tests(const std::vector<TestRecord>& tests, const std::string& name) {
  const auto missing = [&](const char* what, const char* mode) {
    throw InvalidInput(
        fmt::format("{}: tests: none of role calibration is {}; add {{\"mode\": \"{}\", \"role\": \"calibration\"}}",
                    name, what, mode));
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
void log_warnings(const Dataset& dataset, Session& session) {
  std::size_t tests = 0;
  std::string first;
  for (const DatasetTest& test : dataset.tests) {
    if (test.warnings.empty()) continue;
    if (first.empty()) first = fmt::format("{}: {}", test.record.name, test.warnings.front());
    ++tests;
  }
  if (tests > 0)
    session.watch.log(fmt::format("warning: {} of {} tests have warnings (listed in dataset.json), e.g. {}", tests,
                                  dataset.tests.size(), first));
}

std::string summary_of(const fs::path& output, const Dataset& dataset, bool converged, const dem::RunCounts& counts,
                       const Session& session) {
  const std::string parameters = (output / "parameters.json").string();
  const double seconds = session.stopwatch.seconds(), memory = peak_memory_megabytes();
  if (!session.json) {
    return fmt::format("{}\n{} runs ({} found finished), {} tests, {:.1f} s, {:.0f} MB\n{}\n", summary_table(output),
                       counts.runs, counts.found, dataset.tests.size(), seconds, memory, parameters);
  }
  return json_text({{"folder", output.string()},
                    {"parameters", parameters},
                    {"converged", converged},
                    {"tests", dataset.tests.size()},
                    {"runs", counts.runs},
                    {"runs_found", counts.found},
                    {"dataset_digest", dataset.digest},
                    {"seconds", seconds},
                    {"peak_memory_MB", memory}});
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

fit::Calibration fit_and_save(const Dataset& dataset, const fit::CalibrationOptions& options, const fs::path& output,
                              Session& session) {
  session.watch.begin({1}, "");
  const std::vector<TestRecord> tests = tests_of(dataset, Role::calibration);
  fit::Calibration calibration = fit::calibrate(tests, options, session.watch.control(0, "fit", session.stop));
  calibration.law.dataset_digest = dataset.digest;
  if (options.profiles) {
    calibration.left_out =
        fit::leave_one_out(tests, options, session.watch.control(0, "fit without one packing", session.stop));
  }
  fit::ModeComparison modes;
  modes.descriptions = fit::describe(described_tests(dataset), calibration.law.parameters.isotropic.pressure.nu_c,
                                     options, session.watch.control(0, "fit of the other modes", session.stop));
  modes.verdicts = fit::verdicts_of(calibration.law, modes.descriptions, dataset.seeds.size());
  std::vector<TestRecord> shown = tests;
  for (const TestRecord& test : tests_of(dataset, Role::description)) shown.push_back(test);
  modes.claims = fit::claims_of(shown, calibration.law, modes.descriptions, options.steady_from);
  session.watch.end();
  const OrderedJson origin = provenance(session);
  fit::write_calibration(output / "calibration.json", calibration, options, modes, origin);
  write_parameters(output / "parameters.json", {calibration.law, Json(origin)});
  for (const fit::Stage& stage : calibration.stages) {
    if (!stage.converged)
      session.watch.log(fmt::format("stage '{}' of the fit did not converge: {}", stage.name, stage.termination));
  }
  for (const std::string& warning : calibration.warnings) session.watch.log("warning: " + warning);
  return calibration;
}

}  // namespace

ExitCode calibrate(const CalibrateOptions& options, Session& session) {
  if (options.spec.empty() && options.dataset.empty()) {
    throw InvalidInput("calibrate: misses SPEC.json; give it, or --dataset with the folder of a data set");
  }
  std::optional<dem::Spec> spec;
  std::optional<Dataset> given;
  fs::path from;
  if (!options.dataset.empty()) {
    from = dataset_folder(options.dataset);
    given = read_dataset(from);
    check_tests(tests_of(*given, Role::calibration), from.string());
  }
  if (!options.spec.empty()) {
    spec = dem::read_spec(options.spec);
  } else if (!given->spec.is_null()) {
    spec = dem::spec_from_json(given->spec, (from / "dataset.json").string() + ": spec");
  }
  if (!given) check_tests(calibration_tests(plan(*spec)), options.spec.string());
  fit::CalibrationOptions fit_options;
  fit_options.threads = session.threads;
  fit_options.loss = options.loss;
  fit_options.starts = options.starts;
  fit_options.profiles = options.checks;
  fit_options.coupling =
      options.coupling.value_or(spec ? value_of<Coupling>(spec->coupling, "coupling") : Coupling::energy);
  if (spec) spec->coupling = to_string(fit_options.coupling);

  const std::optional<chain::PrecisionTarget> target =
      options.target_error ? std::optional(target_of(options, spec)) : std::nullopt;
  make_output_folder(options.output);
  const fs::path dataset_output = make_subfolder(options.output, "dataset");
  dem::RunCounts counts;
  const auto simulate = [&](const dem::Spec& with, const fs::path& folder) {
    const dem::RunStore store(options.output, "runs");
    Dataset result = dem::run_planned(plan(with), Json(dem::spec_to_json(with)), folder, store, session, counts);
    log_warnings(result, session);
    return result;
  };
  const auto simulate_and_fit = [&](const dem::Spec& with, Dataset& result, double& fit_seconds) {
    const OrderedJson document = dem::spec_to_json(with);
    remove_results_of_others(options.output, json_text(document));
    write_json(options.output / "spec.resolved.json", document);
    result = simulate(with, dataset_output);
    const Stopwatch stopwatch;
    fit::Calibration calibration = fit_and_save(result, fit_options, options.output, session);
    fit_seconds = stopwatch.seconds();
    return calibration;
  };
  if (target) return calibrate_for(*target, *spec, options, simulate_and_fit, simulate, session);
  Dataset dataset;
  bool converged = false;
  if (given) {
    remove_results_of_others(options.output, "");
    if (spec) write_json(options.output / "spec.resolved.json", dem::spec_to_json(*spec));
    dataset = adopt(*given, from, dataset_output);
    log_warnings(dataset, session);
    converged = fit_and_save(dataset, fit_options, options.output, session).law.converged;
  } else {
    double fit_seconds = 0;
    converged = simulate_and_fit(*spec, dataset, fit_seconds).law.converged;
  }
  print_result(summary_of(options.output, dataset, converged, counts, session));
  return converged ? ExitCode::ok : ExitCode::not_converged;
}

}  // namespace grainlaw::app
