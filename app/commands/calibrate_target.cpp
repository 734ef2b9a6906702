#include "app/commands/calibrate_target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "chain/planning/plan_file.hpp"
#include "chain/planning/plan_pilot.hpp"
#include "chain/planning/planned_spec.hpp"
#include "model/files/output_folder.hpp"
#include "model/files/path_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

std::vector<TestRecord> rehearsals(const Dataset& dataset) {
  std::vector<TestRecord> tests = tests_of(dataset, Role::validation);
  std::erase_if(tests, [](const TestRecord& test) { return !test.name.starts_with(chain::kRehearsal); });
  return tests;
}

/// Coarser settings that a bias is measured against.
chain::PlanSettings faster(chain::PlanSettings pilot) {
  pilot.strain_rate *= 8;
  return pilot;
}
chain::PlanSettings smaller(chain::PlanSettings pilot) {
  pilot.particles /= 4;
  pilot.packings *= 2;  // they scatter more
  return pilot;
}

/// The pilot's findings from its own runs and those at the coarser settings.
chain::PlanFindings findings_of(const chain::PrecisionTarget& target, const chain::Scale& scale,
                                const chain::PredictionError& known, const std::vector<TestRecord>& tests,
                                const std::vector<TestRecord>& of_faster, const std::vector<TestRecord>& of_smaller,
                                const chain::CostRates& rates) {
  const chain::PlanSettings& pilot = scale.pilot;
  const auto apart = [&](chain::Cause cause, const chain::PlanSettings& coarse) {
    return shape(cause, coarse, scale) - shape(cause, pilot, scale);
  };
  chain::PlanFindings findings{scale, pilot, {}, rates};
  for (const std::string& quantity : target.quantities) {
    chain::QuantityFindings q{
        quantity, std::nan(""), chain::steady_scatter(tests, quantity, chain::plan_strains(pilot)), {}};
    for (const chain::QuantityPrecision& p : known.quantities) {
      if (p.quantity == quantity) q.half_width = p.half_width;
    }
    const chain::Difference of_rate = chain::difference_of(of_faster, tests, quantity, true);
    const chain::Difference of_size = chain::difference_of(of_smaller, tests, quantity, false);
    q.biases = {chain::bias_of(of_rate.mean, of_rate.standard_error, apart(chain::Cause::strain_rate, faster(pilot))),
                chain::Bias{std::nan(""), std::nan(""), chain::energy_residual(tests), 0},
                chain::bias_of(of_size.mean, of_size.standard_error, apart(chain::Cause::size, smaller(pilot)))};
    findings.quantities.push_back(q);
  }
  return findings;
}

/// Keys of the SPEC that differ in `planned`.
Json overrides(const dem::Spec& frame, const dem::Spec& planned) {
  const OrderedJson before = dem::spec_to_json(frame), after = dem::spec_to_json(planned);
  Json changed = Json::object();
  for (const auto& item : after.items()) {
    if (before[item.key()] != item.value()) changed[item.key()] = Json(item.value());
  }
  return changed;
}

std::string table_of(const chain::TargetRun& run, const chain::PrecisionTarget& target, const dem::Spec& planned,
                     const fs::path& output) {
  std::string text = fmt::format("{:>8} {:>9} {:>8} {:>5} {:>4} {:>6} {:>9} {:>9} {:>8}\n", "packings", "particles",
                                 "rate", "step", "nu", "strain", "seconds", "expected", "stated");
  for (const chain::TargetRound& r : run.rounds) {
    const chain::PlanSettings& s = r.settings;
    const auto percent = [](double x) { return std::isfinite(x) ? fmt::format("{:.2f}%", 100 * x) : "-"; };
    text += fmt::format("{:8} {:9} {:8.4g} {:5.2g} {:4} {:6.2g} {:9.1f} {:>9} {:>8}\n", s.packings, s.particles,
                        s.strain_rate, s.time_step_fraction, s.densities, s.shear_strain, r.seconds,
                        percent(r.expected_error), percent(r.error));
  }
  text += text_of(run.rounds.back()) + "\n";
  text += fmt::format("sheared at {}: the laws of shear are known there, beyond they are extrapolated\n",
                      fmt::join(planned.densities, ", "));
  return text + fmt::format("wanted {:.2f} %: {}\n{}\n", 100 * target.error, to_string(run.outcome),
                            (output / "parameters.json").string());
}

}  // namespace

chain::PrecisionTarget target_of(const CalibrateOptions& options, const std::optional<dem::Spec>& frame) {
  if (!options.dataset.empty())
    throw InvalidInput("calibrate: --target-error makes new runs, which --dataset cannot; leave one of them out");
  if (options.target_path.empty())
    throw InvalidInput("calibrate: --target-error is that of a prediction; give its PATH with --for");
  if (frame && frame->preparation.drive.quasi_static_step > 0)
    throw InvalidInput(
        fmt::format("{}: quasi_static_step: a plan chooses strain rate and time step, which minimised steps "
                    "do not have; leave it 0",
                    options.spec.string()));
  const Path path = read_path(options.target_path).path;
  if (law_decides(path))
    throw InvalidInput(fmt::format("{}: segments: leave the strain to the law; a target needs a path of given strain",
                                   options.target_path.string()));
  const bool shears = shear_direction(resolve(path)).norm() > 0;
  chain::PrecisionTarget target{*options.target_error, options.quantities, path, options.max_cost};
  if (target.quantities.empty()) {
    target.quantities = {"P_star"};
    if (shears) target.quantities.insert(target.quantities.end(), {"s_par", "F_par"});
  }
  for (const std::string& quantity : target.quantities) {
    if (quantity != "P_star" && !shears)
      throw InvalidInput(fmt::format("{}: has no shear, along which {} would be measured; give --quantity P_star",
                                     options.target_path.string(), quantity));
  }
  return target;
}

ExitCode calibrate_for(const chain::PrecisionTarget& target, const dem::Spec& spec, const CalibrateOptions& options,
                       const Calibrate& calibrate_with, const Simulate& simulate, Session& session) {
  const chain::PlanSettings pilot = chain::pilot_settings(spec);
  const chain::Work pilot_work = chain::work_of(chain::planned_spec(spec, pilot, target.path));
  Dataset dataset;
  double fit_seconds = 0;
  chain::TargetActions actions;
  actions.calibrate = [&](const chain::PlanSettings& settings) {
    const fit::Calibration calibration =
        calibrate_with(chain::rounds_of(chain::planned_spec(spec, settings, target.path)), dataset, fit_seconds);
    return chain::prediction_error(calibration.law, target.path, rehearsals(dataset));
  };
  actions.explore = [&](const chain::PredictionError& known) {
    const chain::CostRates rates = chain::cost_rates(dataset, pilot_work, fit_seconds, session.threads);
    const fs::path folder = make_subfolder(options.output, "pilot");
    const auto coarser = [&](const char* name, const chain::PlanSettings& settings) {
      return tests_of(
          simulate(chain::rounds_of(chain::planned_spec(spec, settings, target.path)), make_subfolder(folder, name)),
          Role::calibration);
    };
    return findings_of(target, {pilot, spec.preparation.drive.strain_rate}, known, tests_of(dataset, Role::calibration),
                       coarser("faster", faster(pilot)), coarser("smaller", smaller(pilot)), rates);
  };
  std::map<std::pair<int, double>, chain::Work> works;  // by what does not scale
  actions.work = [&](const chain::PlanSettings& settings) {
    chain::PlanSettings at = pilot;
    at.densities = settings.densities;
    at.shear_strain = settings.shear_strain;
    const auto [entry, is_new] = works.try_emplace({at.densities, at.shear_strain});
    if (is_new) entry->second = chain::work_of(chain::planned_spec(spec, at, target.path));
    return scaled(entry->second, at, settings);
  };
  actions.seconds = [&] { return session.stopwatch.seconds(); };
  actions.log = [&](const std::string& text) { session.watch.log(text); };
  const chain::TargetRun run =
      reach(target, pilot, chain::plan_grid(pilot, spec.preparation.drive.strain_rate), actions);

  const dem::Spec planned = chain::planned_spec(spec, run.rounds.back().settings, target.path);
  if (chain::rounds_of(planned).tests.size() < planned.tests.size()) {
    session.watch.log("tests of other roles, of which the plan knew nothing");
    calibrate_with(planned, dataset, fit_seconds);
  }
  const OrderedJson document = chain::plan_to_json(run, target, overrides(spec, planned), provenance(session));
  write_json(options.output / "plan.json", document);
  print_result(session.json ? json_text(document) : table_of(run, target, planned, options.output));
  return run.outcome == chain::TargetOutcome::met ? ExitCode::ok : ExitCode::not_converged;
}

}  // namespace grainlaw::app
