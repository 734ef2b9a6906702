#include "chain/planning/target_calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "chain/planning/plan_pilot.hpp"
#include "chain/planning/planned_spec.hpp"
#include "model/files/output.hpp"
#include "model/files/path_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

std::vector<TestRecord> rehearsals(const Dataset& dataset) {
  std::vector<TestRecord> tests = tests_of(dataset, Role::validation);
  std::erase_if(tests, [](const TestRecord& test) { return !test.name.starts_with(kRehearsal); });
  return tests;
}

/// Coarser settings that a bias is measured against.
PlanSettings faster(PlanSettings pilot) {
  pilot.strain_rate *= 8;
  return pilot;
}
PlanSettings smaller(PlanSettings pilot) {
  pilot.particles /= 4;
  pilot.packings *= 2;  // they scatter more
  return pilot;
}

/// The pilot's findings from its own runs and those at the coarser settings.
PlanFindings findings_of(const PrecisionTarget& target, const Scale& scale, const PredictionError& known,
                         const std::vector<TestRecord>& tests, const std::vector<TestRecord>& of_faster,
                         const std::vector<TestRecord>& of_smaller, const CostRates& rates) {
  const PlanSettings& pilot = scale.pilot;
  const auto apart = [&](Cause cause, const PlanSettings& coarse) {
    return shape(cause, coarse, scale) - shape(cause, pilot, scale);
  };
  PlanFindings findings{scale, pilot, {}, rates};
  for (const std::string& quantity : target.quantities) {
    QuantityFindings q{quantity, std::nan(""), steady_scatter(tests, quantity, plan_strains(pilot)), {}};
    for (const QuantityPrecision& p : known.quantities) {
      if (p.quantity == quantity) q.half_width = p.half_width;
    }
    const Difference of_rate = difference_of(of_faster, tests, quantity, true);
    const Difference of_size = difference_of(of_smaller, tests, quantity, false);
    q.biases = {bias_of(of_rate.mean, of_rate.standard_error, apart(Cause::strain_rate, faster(pilot))),
                Bias{std::nan(""), std::nan(""), energy_residual(tests), 0},
                bias_of(of_size.mean, of_size.standard_error, apart(Cause::size, smaller(pilot)))};
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

}  // namespace

PrecisionTarget read_target(double error, const fs::path& path, const std::vector<std::string>& quantities,
                            double max_seconds) {
  PrecisionTarget target{error, quantities, read_path(path).path, max_seconds};
  if (law_decides(target.path))
    throw InvalidInput(
        fmt::format("{}: segments: leave the strain to the law; a target needs a path of given strain", path.string()));
  const bool shears = shear_direction(resolve(target.path)).norm() > 0;
  if (target.quantities.empty()) {
    target.quantities = {"P_star"};
    if (shears) target.quantities.insert(target.quantities.end(), {"s_par", "F_par"});
  }
  for (const std::string& quantity : target.quantities) {
    if (quantity != "P_star" && !shears)
      throw InvalidInput(fmt::format("{}: has no shear, along which {} would be measured; give --quantity P_star",
                                     path.string(), quantity));
  }
  return target;
}

TargetCalibration calibrate_for(const PrecisionTarget& target, const dem::Spec& spec, const std::string& name,
                                const fit::CalibrationOptions& options, const fs::path& output,
                                const Execution& execution) {
  const PlanSettings pilot = pilot_settings(spec, name);
  const Work pilot_work = work_of(planned_spec(spec, pilot, target.path));
  const auto at = [&](const PlanSettings& settings) { return planned_spec(spec, settings, target.path); };
  CalibrationResult last;
  fit::CalibrationOptions by_packings = options;
  by_packings.prior.reset();  // a plan counts on errors that know as many degrees of freedom as there are packings
  TargetActions actions;
  actions.calibrate = [&](const PlanSettings& settings) {
    last = calibrate({rounds_of(at(settings))}, by_packings, output, execution);
    return prediction_error(last.calibration.law, target.path, rehearsals(last.dataset));
  };
  actions.explore = [&](const PredictionError& known) {
    const CostRates rates = cost_rates(last.dataset, pilot_work, last.fit_seconds, execution.threads);
    const fs::path folder = make_subfolder(output, "pilot");
    const auto coarser = [&](const char* subfolder, const PlanSettings& settings) {
      dem::RunCounts counts;
      return tests_of(
          simulate_data_set(rounds_of(at(settings)), make_subfolder(folder, subfolder), output, execution, counts),
          Role::calibration);
    };
    return findings_of(target, {pilot, spec.preparation.drive.strain_rate}, known,
                       tests_of(last.dataset, Role::calibration), coarser("faster", faster(pilot)),
                       coarser("smaller", smaller(pilot)), rates);
  };
  std::map<std::pair<int, double>, Work> works;  // by what does not scale
  actions.work = [&](const PlanSettings& settings) {
    PlanSettings like_pilot = pilot;
    like_pilot.densities = settings.densities;
    like_pilot.shear_strain = settings.shear_strain;
    const auto [entry, is_new] = works.try_emplace({settings.densities, settings.shear_strain});
    if (is_new) entry->second = work_of(at(like_pilot));
    return scaled(entry->second, like_pilot, settings);
  };
  actions.seconds = [&] { return execution.stopwatch.seconds(); };
  actions.log = [&](const std::string& text) { execution.watch.log(text); };
  TargetCalibration result;
  result.run = reach(target, pilot, plan_grid(pilot, spec.preparation.drive.strain_rate), actions);
  result.planned = at(result.run.rounds.back().settings);
  if (rounds_of(result.planned).tests.size() < result.planned.tests.size()) {
    execution.watch.log("tests of other roles, of which the plan knew nothing");
    calibrate({result.planned}, by_packings, output, execution);  // errors as the plan judged them
  }
  result.document = plan_to_json(result.run, target, overrides(spec, result.planned), provenance(execution));
  write_json(output / "plan.json", result.document);
  return result;
}

}  // namespace grainlaw::chain
