#include "fit/fit_checks_json.hpp"

#include <cmath>

#include "fit/leave_one_out.hpp"

namespace grainlaw::app {

OrderedJson profile_to_json(const fit::Profile& profile) {
  OrderedJson object{{"parameter", profile.parameter},
                     {"reason", profile.reason},
                     {"lower", number_or_null(profile.lower)},
                     {"upper", number_or_null(profile.upper)}};
  OrderedJson& points = object["points"] = OrderedJson::array();
  for (const fit::ProfilePoint& point : profile.points)
    points.push_back({{"value", point.value}, {"excess", number_or_null(point.excess)}});
  if (!profile.experiment.empty()) object["experiment"] = profile.experiment;
  return object;
}

fit::Profile profile_from_json(const Json& object) {
  fit::Profile profile{object.at("parameter"),
                       object.at("reason"),
                       number_or_nan(object.at("lower")),
                       number_or_nan(object.at("upper")),
                       {},
                       object.value("experiment", "")};
  for (const Json& point : object.at("points"))
    profile.points.push_back({point.at("value"), number_or_nan(point.at("excess"))});
  return profile;
}

OrderedJson starts_to_json(const fit::StartSearch& starts) {
  return {{"tried", starts.tried}, {"at_minimum", starts.at_minimum}, {"next_cost", number_or_null(starts.next_cost)}};
}

fit::StartSearch starts_from_json(const Json& object) {
  return {object.at("tried"), object.at("at_minimum"), number_or_nan(object.at("next_cost"))};
}

OrderedJson left_out_to_json(const fit::Calibration& calibration) {
  if (calibration.left_out.empty()) return OrderedJson();
  OrderedJson seeds = OrderedJson::array(), notes = OrderedJson::array(), parameters = OrderedJson::object();
  for (const fit::LeftOut& fit : calibration.left_out) {
    seeds.push_back(fit.seed);
    notes.push_back(fit.note);
  }
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const double stated = calibration.law.estimates[i].standard_error;
    if (!std::isfinite(stated)) continue;
    OrderedJson values = OrderedJson::array();
    for (const fit::LeftOut& fit : calibration.left_out) values.push_back(number_or_null(fit.value[i]));
    const double jackknife = fit::jackknife_error(calibration.left_out, i);
    parameters[parameter_table()[i].name] = {{"values", values},
                                             {"standard_error", stated},
                                             {"jackknife_error", number_or_null(jackknife)},
                                             {"ratio", number_or_null(jackknife / stated)}};
  }
  return {{"seeds", seeds}, {"notes", notes}, {"parameters", parameters}};
}

std::vector<fit::LeftOut> left_out_from_json(const Json& object) {
  std::vector<fit::LeftOut> fits;
  if (object.is_null()) return fits;
  for (std::size_t k = 0; k < object.at("seeds").size(); ++k)
    fits.push_back({object["seeds"][k], std::vector<double>(kParameterCount, std::nan("")), object.at("notes").at(k)});
  for (const auto& item : object.at("parameters").items()) {
    for (std::size_t k = 0; k < fits.size(); ++k)
      fits[k].value[parameter_index(item.key())] = number_or_nan(item.value().at("values").at(k));
  }
  return fits;
}

}  // namespace grainlaw::app
