#include "fit/calibration_file.hpp"

#include <fmt/format.h>

#include <cmath>

#include "fit/leave_one_out.hpp"
#include "model/density_curves.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

OrderedJson stage_to_json(const Stage& stage) {
  OrderedJson object = fields_to_json(stage);
  OrderedJson& profiles = object["profiles"] = OrderedJson::array();
  for (const Profile& profile : stage.profiles) {
    profiles.push_back(fields_to_json(profile));
    if (!profile.experiment.empty()) profiles.back()["experiment"] = profile.experiment;
  }
  OrderedJson& estimates = object["estimates"] = OrderedJson::object();
  for (const NamedEstimate& named : stage.estimates) estimates[named.name] = named.estimate;
  object["tests"] = fields_to_json(stage.tests);
  return object;
}

Stage stage_from_json(const Json& object) {
  Stage stage;
  read_fields(object, stage);
  for (const Json& each : object.at("profiles")) {
    Profile& profile = stage.profiles.emplace_back();
    read_fields(each, profile);
    profile.experiment = each.value("experiment", "");
  }
  for (const auto& item : object.at("estimates").items())
    stage.estimates.push_back({item.key(), item.value().get<Estimate>()});
  read_fields(object.at("tests"), stage.tests);
  return stage;
}

/// Ours beside the published curves of `mode`; null where the data do not determine ours.
OrderedJson curves_to_json(const Calibration& calibration, const std::string& mode) {
  OrderedJson curves = OrderedJson::array();
  for (const CurvePoint& point : curve_points(calibration.law.parameters, published_parameters(mode),
                                              calibration.law.range.nu_min, calibration.law.range.nu_max)) {
    const bool known = has_values(calibration.law, *point.curve);
    const double error = known ? standard_error(calibration.law, *point.curve, point.nu) : std::nan("");
    curves.push_back({{"quantity", point.curve->quantity},
                      {"nu", point.nu},
                      {"ours", known ? number_or_null(point.ours) : OrderedJson()},
                      {"standard_error", number_or_null(error)},
                      {"published", number_or_null(point.published)}});
  }
  return curves;
}

OrderedJson stages_to_json(const Calibration& calibration) {
  OrderedJson stages = OrderedJson::array();
  for (const Stage& stage : calibration.stages) stages.push_back(stage_to_json(stage));
  return stages;
}

/// `object` holds "stages" and "shear".
void read_stages(const Json& object, Calibration& calibration) {
  for (const Json& stage : object.at("stages")) calibration.stages.push_back(stage_from_json(stage));
  read_fields(object.at("shear"), calibration.shear);
}

/// Seeds, and per parameter with an error: values without each of them, stated and jackknife error; null without any fit.
OrderedJson left_out_to_json(const Calibration& calibration) {
  if (calibration.left_out.empty()) return OrderedJson();
  OrderedJson seeds = OrderedJson::array(), notes = OrderedJson::array(), parameters = OrderedJson::object();
  for (const LeftOut& fit : calibration.left_out) {
    seeds.push_back(fit.seed);
    notes.push_back(fit.note);
  }
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const double stated = calibration.law.estimates[i].standard_error;
    if (!std::isfinite(stated)) continue;
    OrderedJson values = OrderedJson::array();
    for (const LeftOut& fit : calibration.left_out) values.push_back(number_or_null(fit.value[i]));
    const double jackknife = jackknife_error(calibration.left_out, i);
    parameters[parameter_table()[i].name] = {{"values", values},
                                             {"standard_error", stated},
                                             {"jackknife_error", number_or_null(jackknife)},
                                             {"ratio", number_or_null(jackknife / stated)}};
  }
  return {{"seeds", seeds}, {"notes", notes}, {"parameters", parameters}};
}

/// Values of the parameters that the object names; NaN for the others.
std::vector<LeftOut> left_out_from_json(const Json& object) {
  std::vector<LeftOut> fits;
  if (object.is_null()) return fits;
  for (std::size_t k = 0; k < object.at("seeds").size(); ++k)
    fits.push_back({whole_number<std::uint64_t>(object["seeds"].at(k)),
                    std::vector<double>(kParameterCount, std::nan("")), object.at("notes").at(k)});
  for (const auto& item : object.at("parameters").items()) {
    for (std::size_t k = 0; k < fits.size(); ++k)
      fits[k].value[parameter_index(item.key())] = number_or_nan(item.value().at("values").at(k));
  }
  return fits;
}

OrderedJson description_to_json(const Description& d) {
  return {{"name", d.name},
          {"stages", stages_to_json(d.calibration)},
          {"shear", fields_to_json(d.calibration.shear)},
          {"curves", curves_to_json(d.calibration, d.name)}};
}

}  // namespace

void write_calibration(const std::filesystem::path& file, const Calibration& calibration,
                       const CalibrationOptions& options, const ModeComparison& modes, const OrderedJson& provenance) {
  OrderedJson document = OrderedJson::object();
  document["format"] = "grainlaw calibration";
  document["format_version"] = 1;
  document["coupling"] = to_string(calibration.law.coupling);
  document["converged"] = calibration.law.converged;
  document["options"] = fields_to_json(options);
  const Moderation& moderation = calibration.moderation;
  document["moderation"] = {{"parameters", moderation.parameters},
                            {"ratio", options.prior ? number_or_null(moderation.ratio) : OrderedJson()},
                            {"packings", calibration.size.packings},
                            {"spheres", number_or_null(calibration.size.spheres)}};
  document["dataset_digest"] = calibration.law.dataset_digest;
  document["stages"] = stages_to_json(calibration);
  document["shear"] = fields_to_json(calibration.shear);
  document["leave_one_out"] = left_out_to_json(calibration);
  document["curves"] = curves_to_json(calibration, "");
  OrderedJson& descriptions = document["descriptions"] = OrderedJson::array();
  for (const Description& d : modes.descriptions) descriptions.push_back(description_to_json(d));
  document["verdicts"] = fields_to_json(modes.verdicts);
  document["claims"] = fields_to_json(modes.claims);
  document["unused_tests"] = calibration.unused_tests;
  document["warnings"] = calibration.warnings;
  document["provenance"] = provenance;
  write_json(file, document);
}

ModeComparison read_calibration(const std::filesystem::path& file, Calibration& calibration) {
  const Json document = read_json(file, JsonSource::own);
  ModeComparison modes;
  try {
    read_stages(document, calibration);
    calibration.left_out = left_out_from_json(document.at("leave_one_out"));
    for (const Json& object : document.at("descriptions")) {
      modes.descriptions.push_back({object.at("name"), {}});
      read_stages(object, modes.descriptions.back().calibration);
    }
    read_fields(document.at("verdicts"), modes.verdicts);
    read_fields(document.at("claims"), modes.claims);
    calibration.unused_tests = document.at("unused_tests").get<std::vector<std::string>>();
    calibration.warnings = document.at("warnings").get<std::vector<std::string>>();
    if (document.at("dataset_digest") != calibration.law.dataset_digest)
      calibration.warnings.emplace_back(
          "calibration.json is of another data set than parameters.json (digests differ)");
  } catch (const Json::exception& error) {
    throw InvalidInput(fmt::format("{}: is no calibration.json of this version: {}; run grainlaw calibrate again",
                                   one_line(file.string(), 200), one_line(error.what(), 200)));
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", one_line(file.string(), 200), one_line(error.what(), 300)));
  }
  return modes;
}

}  // namespace grainlaw::fit
