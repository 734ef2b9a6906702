#include "chain/planning/plan_file.hpp"

#include "model/files/path_json.hpp"

namespace grainlaw::chain {
namespace {

OrderedJson settings_to_json(const PlanSettings& s) {
  return {{"particles", s.particles},     {"packings", s.packings},
          {"strain_rate", s.strain_rate}, {"time_step_fraction", s.time_step_fraction},
          {"densities", s.densities},     {"shear_strain", s.shear_strain}};
}

OrderedJson findings_to_json(const QuantityFindings& findings, const Scale& scale) {
  OrderedJson object{{"quantity", findings.quantity}, {"half_width", number_or_null(findings.half_width)}};
  OrderedJson& scatter = object["scatter"] = OrderedJson::array();
  for (const SteadyScatter& s : findings.scatter)
    scatter.push_back({{"shear_strain", s.shear_strain}, {"between", s.between}, {"within", s.within}});
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
  OrderedJson object{{"settings", settings_to_json(round.settings)},
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

OrderedJson plan_to_json(const TargetRun& run, const PrecisionTarget& target, const Json& overrides,
                         const OrderedJson& provenance) {
  OrderedJson document{{"format", "grainlaw plan"}, {"format_version", 2}, {"target_error", target.error}};
  document["quantities"] = target.quantities;
  document["path"] = path_to_json(target.path);
  document["max_seconds"] = target.max_seconds;
  document["outcome"] = to_string(run.outcome);
  document["overrides"] = overrides;
  OrderedJson& pilot = document["pilot"];
  pilot["settings"] = settings_to_json(run.pilot.scale.pilot);
  pilot["wanted_strain_rate"] = run.pilot.scale.wanted_rate;
  pilot["seconds_per_particle_step"] = run.pilot.rates.particle_step;
  pilot["seconds_per_relaxed_particle"] = run.pilot.rates.relaxed;
  pilot["seconds_per_fitted_test"] = run.pilot.rates.fitted_test;
  OrderedJson& quantities = pilot["quantities"] = OrderedJson::array();
  for (const QuantityFindings& findings : run.pilot.quantities)
    quantities.push_back(findings_to_json(findings, run.pilot.scale));
  OrderedJson& candidates = document["candidates"] = OrderedJson::array();
  for (const Candidate& c : run.candidates) {
    OrderedJson entry = settings_to_json(c.settings);
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
