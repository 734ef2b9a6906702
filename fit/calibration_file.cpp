#include "fit/calibration_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/leave_one_out.hpp"
#include "fit/statistics/curve_error.hpp"
#include "model/density_curves.hpp"
#include "model/files/one_line.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

OrderedJson residual_to_json(const TestResidual& r) {
  return {{"test", r.test},
          {"quantity", r.quantity},
          {"in_cost", r.in_cost},
          {"rows", r.rows},
          {"rows_excluded", r.rows_excluded},
          {"rows_lightened", r.rows_lightened},
          {"rms", number_or_null(r.rms)},
          {"bias", number_or_null(r.bias)},
          {"max_abs_data", number_or_null(r.max_abs_data)}};
}

TestResidual residual_from_json(const Json& object) {
  TestResidual r;
  r.test = object.at("test");
  r.quantity = object.at("quantity");
  r.in_cost = object.at("in_cost");
  r.rows = object.at("rows");
  r.rows_excluded = object.at("rows_excluded");
  r.rows_lightened = object.at("rows_lightened");
  r.rms = number_or_nan(object.at("rms"));
  r.bias = number_or_nan(object.at("bias"));
  r.max_abs_data = number_or_nan(object.at("max_abs_data"));
  return r;
}

OrderedJson profile_to_json(const Profile& profile) {
  OrderedJson object{{"parameter", profile.parameter},
                     {"reason", profile.reason},
                     {"lower", number_or_null(profile.lower)},
                     {"upper", number_or_null(profile.upper)}};
  OrderedJson& points = object["points"] = OrderedJson::array();
  for (const ProfilePoint& point : profile.points)
    points.push_back({{"value", point.value}, {"excess", number_or_null(point.excess)}});
  if (!profile.experiment.empty()) object["experiment"] = profile.experiment;
  return object;
}

Profile profile_from_json(const Json& object) {
  Profile profile{object.at("parameter"),
                  object.at("reason"),
                  number_or_nan(object.at("lower")),
                  number_or_nan(object.at("upper")),
                  {},
                  object.value("experiment", "")};
  for (const Json& point : object.at("points"))
    profile.points.push_back({point.at("value"), number_or_nan(point.at("excess"))});
  return profile;
}

OrderedJson starts_to_json(const StartSearch& starts) {
  return {{"tried", starts.tried}, {"at_minimum", starts.at_minimum}, {"next_cost", number_or_null(starts.next_cost)}};
}

StartSearch starts_from_json(const Json& object) {
  return {object.at("tried"), object.at("at_minimum"), number_or_nan(object.at("next_cost"))};
}

OrderedJson stage_to_json(const Stage& stage) {
  OrderedJson object{{"name", stage.name},
                     {"window", stage.window},
                     {"residuals", stage.residuals},
                     {"free_parameters", stage.free_parameters},
                     {"iterations", stage.iterations},
                     {"initial_cost", number_or_null(stage.initial_cost)},
                     {"final_cost", number_or_null(stage.final_cost)},
                     {"termination", stage.termination},
                     {"converged", stage.converged},
                     {"seconds", stage.seconds}};
  object["starts"] = starts_to_json(stage.starts);
  OrderedJson& profiles = object["profiles"] = OrderedJson::array();
  for (const Profile& profile : stage.profiles) profiles.push_back(profile_to_json(profile));
  OrderedJson& estimates = object["estimates"] = OrderedJson::object();
  for (const NamedEstimate& named : stage.estimates) estimates[named.name] = estimate_to_json(named.estimate);
  OrderedJson& tests = object["tests"] = OrderedJson::array();
  for (const TestResidual& residual : stage.tests) tests.push_back(residual_to_json(residual));
  return object;
}

Stage stage_from_json(const Json& object) {
  Stage stage;
  stage.name = object.at("name");
  stage.window = object.at("window");
  stage.residuals = object.at("residuals");
  stage.free_parameters = object.at("free_parameters");
  stage.iterations = object.at("iterations");
  stage.initial_cost = number_or_nan(object.at("initial_cost"));
  stage.final_cost = number_or_nan(object.at("final_cost"));
  stage.termination = object.at("termination");
  stage.converged = object.at("converged");
  stage.seconds = object.at("seconds");
  stage.starts = starts_from_json(object.at("starts"));
  for (const Json& profile : object.at("profiles")) stage.profiles.push_back(profile_from_json(profile));
  for (const auto& item : object.at("estimates").items())
    stage.estimates.push_back({item.key(), estimate_from_json(item.value())});
  for (const Json& residual : object.at("tests")) stage.tests.push_back(residual_from_json(residual));
  return stage;
}

// The numbers of a shear fit that are no estimates, under their JSON keys.
constexpr std::array<std::pair<const char*, double ShearFit::*>, 13> kShearNumbers{{
    {"nu", &ShearFit::nu},
    {"eps_dev_max", &ShearFit::eps_dev_max},
    {"s_0", &ShearFit::s_0},
    {"F_0", &ShearFit::F_0},
    {"s_steady", &ShearFit::s_steady},
    {"F_steady", &ShearFit::F_steady},
    {"C_star", &ShearFit::C_star},
    {"rattler_fraction", &ShearFit::rattler_fraction},
    {"P_star", &ShearFit::P_star},
    {"steady_from", &ShearFit::steady_from},
    {"steady_since_s", &ShearFit::steady_since_s},
    {"steady_since_F", &ShearFit::steady_since_F},
    {"steady_since_P", &ShearFit::steady_since_P},
}};
constexpr std::array<std::pair<const char*, Estimate ShearFit::*>, 4> kShearEstimates{{
    {"s_max", &ShearFit::s_max},
    {"beta_s", &ShearFit::beta_s},
    {"F_max", &ShearFit::F_max},
    {"beta_F", &ShearFit::beta_F},
}};

OrderedJson shear_to_json(const ShearFit& shear) {
  OrderedJson object{{"test", shear.test}, {"mode", to_string(shear.mode)}, {"seed", shear.seed}};
  for (const auto& [key, member] : kShearNumbers) object[key] = number_or_null(shear.*member);
  for (const auto& [key, member] : kShearEstimates) object[key] = estimate_to_json(shear.*member);
  return object;
}

ShearFit shear_from_json(const Json& object) {
  ShearFit shear;
  shear.test = object.at("test");
  shear.mode = value_of<Mode>(object.at("mode").get<std::string>(), "mode");
  shear.seed = object.at("seed");
  for (const auto& [key, member] : kShearNumbers) shear.*member = number_or_nan(object.at(key));
  for (const auto& [key, member] : kShearEstimates) shear.*member = estimate_from_json(object.at(key));
  return shear;
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

OrderedJson shears_to_json(const Calibration& calibration) {
  OrderedJson shear = OrderedJson::array();
  for (const ShearFit& fit : calibration.shear) shear.push_back(shear_to_json(fit));
  return shear;
}

/// `object` holds "stages" and "shear".
void read_stages(const Json& object, Calibration& calibration) {
  for (const Json& stage : object.at("stages")) calibration.stages.push_back(stage_from_json(stage));
  for (const Json& shear : object.at("shear")) calibration.shear.push_back(shear_from_json(shear));
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
    fits.push_back({object["seeds"][k], std::vector<double>(kParameterCount, std::nan("")), object.at("notes").at(k)});
  for (const auto& item : object.at("parameters").items()) {
    for (std::size_t k = 0; k < fits.size(); ++k)
      fits[k].value[parameter_index(item.key())] = number_or_nan(item.value().at("values").at(k));
  }
  return fits;
}

OrderedJson description_to_json(const Description& d) {
  return {{"name", d.name},
          {"stages", stages_to_json(d.calibration)},
          {"shear", shears_to_json(d.calibration)},
          {"curves", curves_to_json(d.calibration, d.name)}};
}

OrderedJson verdict_to_json(const Verdict& v) {
  return {{"mode", v.mode},
          {"quantity", v.quantity},
          {"nu", v.is_parameter ? OrderedJson() : OrderedJson(v.nu)},
          {"ours", number_or_null(v.ours)},
          {"standard_error", number_or_null(v.standard_error)},
          {"published", v.published},
          {"distance", number_or_null(v.distance)},
          {"verdict", v.verdict}};
}

Verdict verdict_from_json(const Json& object) {
  const bool is_parameter = object.at("nu").is_null();
  return {object.at("mode"),
          object.at("quantity"),
          is_parameter,
          is_parameter ? 0 : object.at("nu").get<double>(),
          number_or_nan(object.at("ours")),
          number_or_nan(object.at("standard_error")),
          object.at("published"),
          number_or_nan(object.at("distance")),
          object.at("verdict")};
}

OrderedJson claim_to_json(const Claim& c) {
  return {{"where", c.where},
          {"statement", c.statement},
          {"nu", number_or_null(c.nu)},
          {"ours", c.ours},
          {"standard_error", number_or_null(c.standard_error)},
          {"published", number_or_null(c.published)},
          {"verdict", c.verdict}};
}

Claim claim_from_json(const Json& object) {
  return {object.at("where"),
          object.at("statement"),
          number_or_nan(object.at("nu")),
          object.at("ours"),
          number_or_nan(object.at("standard_error")),
          number_or_nan(object.at("published")),
          object.at("verdict")};
}

}  // namespace

void write_calibration(const std::filesystem::path& file, const Calibration& calibration,
                       const CalibrationOptions& options, const ModeComparison& modes, const OrderedJson& provenance) {
  OrderedJson document;
  document["format"] = "grainlaw calibration";
  document["format_version"] = 1;
  document["coupling"] = to_string(calibration.law.coupling);
  document["converged"] = calibration.law.converged;
  document["options"] = {{"iso_nu_min", options.iso_nu_min},
                         {"rate_window", options.rate_window},
                         {"steady_from", options.steady_from},
                         {"steady_weight", options.steady_weight},
                         {"stiffness_window", options.stiffness_window},
                         {"lag_window", options.lag_window},
                         {"max_step", options.max_step},
                         {"pressure_scale", options.pressure_scale},
                         {"stress_scale", options.stress_scale},
                         {"fabric_scale", options.fabric_scale},
                         {"loss", to_string(options.loss)},
                         {"starts", options.starts}};
  document["dataset_digest"] = calibration.law.dataset_digest;
  document["stages"] = stages_to_json(calibration);
  document["shear"] = shears_to_json(calibration);
  document["leave_one_out"] = left_out_to_json(calibration);
  document["curves"] = curves_to_json(calibration, "");
  OrderedJson& descriptions = document["descriptions"] = OrderedJson::array();
  for (const Description& d : modes.descriptions) descriptions.push_back(description_to_json(d));
  OrderedJson& verdicts = document["verdicts"] = OrderedJson::array();
  for (const Verdict& v : modes.verdicts) verdicts.push_back(verdict_to_json(v));
  OrderedJson& claims = document["claims"] = OrderedJson::array();
  for (const Claim& claim : modes.claims) claims.push_back(claim_to_json(claim));
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
    for (const Json& verdict : document.at("verdicts")) modes.verdicts.push_back(verdict_from_json(verdict));
    for (const Json& claim : document.at("claims")) modes.claims.push_back(claim_from_json(claim));
    calibration.unused_tests = document.at("unused_tests").get<std::vector<std::string>>();
    calibration.warnings = document.at("warnings").get<std::vector<std::string>>();
  } catch (const Json::exception& error) {
    throw InvalidInput(fmt::format("{}: is no calibration.json of this version: {}; run grainlaw calibrate again",
                                   one_line(file.string(), 200), one_line(error.what(), 200)));
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", one_line(file.string(), 200), error.what()));
  }
  return modes;
}

}  // namespace grainlaw::fit
