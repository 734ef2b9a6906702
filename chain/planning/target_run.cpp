#include "chain/planning/target_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/files/fields_json.hpp"
#include "model/files/path_json.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kAim = 0.9;   // of the target: what is expected is itself uncertain
constexpr double kGrowth = 4;  // of packings times spheres over the largest round's: errors at most halved
constexpr int kRoundsWithoutBand = 3;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const QuantityPrecision* find(const PredictionError& known, const std::string& quantity) {
  const auto at = std::find_if(known.quantities.begin(), known.quantities.end(),
                               [&](const QuantityPrecision& q) { return q.quantity == quantity; });
  return at == known.quantities.end() ? nullptr : &*at;
}

/// Bands as they are, biases by `findings`.
void judge(const PlanFindings& findings, TargetRound& round) {
  round.errors.clear();
  round.error = 0;
  for (const QuantityFindings& q : findings.quantities) {
    ExpectedError error = expected(q, findings, round.settings);
    const QuantityPrecision* precision = find(round.known, q.quantity);
    error.half_width = precision == nullptr ? std::nan("") : precision->half_width;
    round.errors.push_back(error);
    round.error =
        std::isnan(error.total()) || std::isnan(round.error) ? std::nan("") : std::max(round.error, error.total());
  }
}

std::vector<double> half_widths(const TargetRound& round) {
  std::vector<double> widths;
  for (const ExpectedError& error : round.errors) widths.push_back(error.half_width);
  return widths;
}

/// The last round that knows something; if none does, the last.
const TargetRound& last_with_band(const std::vector<TargetRound>& rounds) {
  const auto known = std::find_if(rounds.rbegin(), rounds.rend(), [](const auto& r) { return !std::isnan(r.error); });
  return known == rounds.rend() ? rounds.back() : *known;
}

/// Whether the law is off by more than the target: for sure, or, once the error is reached, as far as is known.
bool is_discrepant(const TargetRound& round, double target) {
  return std::any_of(round.errors.begin(), round.errors.end(), [&](const ExpectedError& error) {
    const QuantityPrecision* p = find(round.known, error.quantity);
    return p != nullptr && (round.error <= target ? p->discrepancy : p->discrepancy_min) > target;
  });
}

/// As many packings of the plan as the rounds until now allow to foresee.
PlanSettings first_part(PlanSettings plan, const std::vector<PlanSettings>& finished) {
  double largest = 0;
  for (const PlanSettings& s : finished) largest = std::max(largest, s.packings * static_cast<double>(s.particles));
  const double most = kGrowth * largest / static_cast<double>(plan.particles);
  plan.packings = std::min(plan.packings, std::max(3, static_cast<int>(most)));
  return plan;
}

OrderedJson findings_to_json(const QuantityFindings& findings, const Scale& scale) {
  OrderedJson object{{"quantity", findings.quantity}, {"half_width", number_or_null(findings.half_width)}};
  object["scatter"] = fields_to_json(findings.scatter);
  OrderedJson& biases = object["biases"] = OrderedJson::array();
  for (std::size_t i = 0; i < kCauses.size(); ++i) {
    const Bias& bias = findings.biases[i];
    const double at_pilot = shape(kCauses[i], scale.pilot, scale);
    biases.push_back({{"cause", to_string(kCauses[i])},
                      {"difference", number_or_null(bias.difference)},
                      {"standard_error", number_or_null(bias.standard_error)},
                      {"estimate", bias.slope * at_pilot},
                      {"resolution", bias.resolution * at_pilot}});
  }
  return object;
}

OrderedJson round_to_json(const TargetRound& round) {
  OrderedJson object{{"settings", fields_to_json(round.settings)},
                     {"expected_error", number_or_null(round.expected_error)},
                     {"expected_seconds", number_or_null(round.expected_seconds)},
                     {"seconds", round.seconds},
                     {"model", to_string(round.known.rung)},
                     {"error", number_or_null(round.error)}};
  OrderedJson& quantities = object["quantities"] = OrderedJson::array();
  for (const ExpectedError& e : round.errors) {
    OrderedJson entry{
        {"quantity", e.quantity}, {"error", number_or_null(e.total())}, {"half_width", number_or_null(e.half_width)}};
    for (std::size_t i = 0; i < kCauses.size(); ++i) entry["bias_" + to_string(kCauses[i])] = e.biases[i];
    for (const QuantityPrecision& p : round.known.quantities) {
      if (p.quantity != e.quantity) continue;
      entry["largest_half_width"] = number_or_null(p.largest);
      entry["discrepancy"] = number_or_null(p.discrepancy);
      entry["discrepancy_min"] = number_or_null(p.discrepancy_min);
    }
    quantities.push_back(entry);
  }
  return object;
}

}  // namespace

std::string text_of(const PlanSettings& s) {
  return fmt::format("{} packings of {} spheres, {:.4g} 1/s, step {:.3g}, {} densities, shear to {:.3g}", s.packings,
                     s.particles, s.strain_rate, s.time_step_fraction, s.densities, s.shear_strain);
}

std::string text_of(const TargetRound& round) {
  std::string text = fmt::format("{} rung:", to_string(round.known.rung));
  for (const ExpectedError& e : round.errors) {
    if (std::isnan(e.half_width)) {
      text += fmt::format(" {} has no band", e.quantity);
      continue;
    }
    const QuantityPrecision* p = find(round.known, e.quantity);
    text += fmt::format(" {} {:.2f} % (band {:.2f}, rate {:.2f}, step {:.2f}, size {:.2f}", e.quantity, 100 * e.total(),
                        100 * e.half_width, 100 * e.biases[0], 100 * e.biases[1], 100 * e.biases[2]);
    if (p != nullptr && std::isfinite(p->discrepancy)) text += fmt::format("; law off by {:.2f}", 100 * p->discrepancy);
    text += ")";
  }
  return text;
}

TargetRun reach(const PrecisionTarget& target, const PlanSettings& pilot, const std::vector<PlanSettings>& grid,
                const TargetActions& actions) {
  TargetRun run;
  const auto perform = [&](const PlanSettings& settings, double expected_error, double expected_seconds) {
    TargetRound round;
    round.settings = settings;
    round.expected_error = expected_error;
    round.expected_seconds = expected_seconds;
    const double begin = actions.seconds();
    round.known = actions.calibrate(settings);
    if (run.rounds.empty()) run.pilot = actions.explore(round.known);
    round.seconds = actions.seconds() - begin;
    judge(run.pilot, round);
    actions.log(text_of(round));
    run.rounds.push_back(round);
  };
  actions.log("pilot: " + text_of(pilot));
  perform(pilot, std::nan(""), std::nan(""));
  int without_band = 0;
  while (true) {
    const TargetRound& last = run.rounds.back();
    const auto ended = [&](TargetOutcome outcome) {
      run.outcome = outcome;
      return run;
    };
    if (is_discrepant(last, target.error)) return ended(TargetOutcome::discrepancy);
    if (last.error <= target.error) return ended(TargetOutcome::met);
    without_band = std::isnan(last.error) ? without_band + 1 : 0;
    if (without_band == kRoundsWithoutBand) return ended(TargetOutcome::no_band);

    const TargetRound& known = last_with_band(run.rounds);
    const PlanFindings findings = rebased(run.pilot, known.settings, half_widths(known));
    const double left = target.max_seconds > 0 ? target.max_seconds - actions.seconds() : kInfinity;
    PlanGoal goal{kAim * target.error, left, {}, std::isnan(last.error) ? kInfinity : last.error};
    for (const TargetRound& round : run.rounds) {
      goal.finished.push_back(round.settings);
      if (std::isnan(round.error)) goal.without_band.push_back(round.settings);
    }
    std::vector<Candidate> candidates;
    for (const PlanSettings& settings : grid) {
      if (const auto c = candidate(settings, actions.work(settings), findings, goal)) candidates.push_back(*c);
    }
    if (run.rounds.size() == 1) run.candidates = candidates;
    const auto chosen = choose(candidates, goal);
    if (!chosen) return ended(TargetOutcome::max_cost);
    const Candidate& plan = candidates[*chosen];
    actions.log(
        fmt::format("plan: {}: expected {:.2f} % in {:.0f} s", text_of(plan.settings), 100 * plan.error, plan.seconds));
    const PlanSettings first = first_part(plan.settings, goal.finished);
    if (first.packings < plan.settings.packings)
      actions.log(fmt::format("first {} of these packings, which will say more", first.packings));
    const Candidate next = candidate_with(first, plan.work, findings, goal);
    perform(first, next.error, next.seconds);
  }
}

OrderedJson plan_to_json(const TargetRun& run, const PrecisionTarget& target, const Json& overrides,
                         const OrderedJson& provenance) {
  OrderedJson document{{"format", "grainlaw plan"}, {"format_version", 2}, {"target_error", target.error}};
  document["quantities"] = target.quantities;
  document["path"] = path_to_json(target.path);
  document["max_seconds"] = target.max_seconds;
  document["outcome"] = to_string(run.outcome);
  document["overrides"] = overrides;
  OrderedJson& pilot = document["pilot"];
  pilot["settings"] = fields_to_json(run.pilot.scale.pilot);
  pilot["wanted_strain_rate"] = run.pilot.scale.wanted_rate;
  pilot["seconds_per_particle_step"] = run.pilot.rates.particle_step;
  pilot["seconds_per_relaxed_particle"] = run.pilot.rates.relaxed;
  pilot["seconds_per_fitted_test"] = run.pilot.rates.fitted_test;
  OrderedJson& quantities = pilot["quantities"] = OrderedJson::array();
  for (const QuantityFindings& findings : run.pilot.quantities)
    quantities.push_back(findings_to_json(findings, run.pilot.scale));
  OrderedJson& candidates = document["candidates"] = OrderedJson::array();
  for (const Candidate& c : run.candidates) {
    OrderedJson entry = fields_to_json(c.settings);
    entry["error"] = c.error;
    entry["seconds"] = c.seconds;
    entry["reaches"] = c.reaches;
    candidates.push_back(entry);
  }
  OrderedJson& rounds = document["rounds"] = OrderedJson::array();
  for (const TargetRound& round : run.rounds) rounds.push_back(round_to_json(round));
  document["provenance"] = provenance;
  return document;
}

}  // namespace grainlaw::chain
