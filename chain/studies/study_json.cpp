#include "chain/studies/study_json.hpp"

namespace grainlaw::chain {
namespace {

OrderedJson quantity_to_json(const QuantityError& e) {
  return {{"quantity", e.quantity},
          {"in_error", e.in_error},
          {"value", number_or_null(e.value)},
          {"error", number_or_null(e.error)},
          {"standard_error", number_or_null(e.standard_error)},
          {"half_width", number_or_null(e.half_width)},
          {"sampling", number_or_null(e.sampling)},
          {"chance", number_or_null(e.chance)}};
}

OrderedJson result_to_json(const SettingResult& r) {
  const SettingOutcome& outcome = r.outcome;
  OrderedJson object{{"setting", outcome.name}};
  OrderedJson& changes = object["changes"] = OrderedJson::object();
  for (const auto& [key, value] : outcome.changes) changes[key] = value;
  object["packings"] = outcome.seeds.size();
  object["particle_steps"] = outcome.cost.particle_steps;
  object["seconds"] = outcome.cost.seconds;
  object["fit_seconds"] = outcome.cost.fit_seconds;
  object["energy_residual"] = outcome.energy_residual;
  object["model"] = outcome.model.empty() ? OrderedJson() : OrderedJson(outcome.model);
  object["same_packings"] = !outcome.compared_with.empty();
  object["error"] = number_or_null(r.error);
  object["floor"] = number_or_null(r.floor);
  object["sampling"] = number_or_null(r.sampling);
  object["noise"] = number_or_null(r.noise);
  object["reached"] = number_or_null(r.reached);
  object["reached_standard_error"] = number_or_null(r.reached_error);
  object["dominated"] = !r.dominated_by.empty();
  object["dominated_by"] = r.dominated_by;
  object["perhaps_dominated_by"] = r.perhaps_dominated_by;
  object["note"] = outcome.note;
  OrderedJson& quantities = object["quantities"] = OrderedJson::array();
  for (const QuantityError& e : r.errors) quantities.push_back(quantity_to_json(e));
  return object;
}

}  // namespace

OrderedJson study_document(const std::string& kind) {
  return {{"format", "grainlaw study"}, {"format_version", 1}, {"study", kind}};
}

OrderedJson study_to_json(const SettingsStudy& study) {
  OrderedJson document = study_document(study.kind);
  document["base"] = study.base;
  document["error"] = study.error;
  document["reference"] = study.results.front().outcome.name;
  const SettingResult& judged = study.results.at(study.judged);
  document["default"] = {{"setting", judged.outcome.name},
                         {"dominated", !judged.dominated_by.empty()},
                         {"dominated_by", judged.dominated_by},
                         {"perhaps_dominated_by", judged.perhaps_dominated_by}};
  OrderedJson& all = document["settings"] = OrderedJson::array();
  for (const SettingResult& r : study.results) all.push_back(result_to_json(r));
  return document;
}

}  // namespace grainlaw::chain
