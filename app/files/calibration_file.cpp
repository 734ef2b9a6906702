#include "app/files/calibration_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "chain/estimate_json.hpp"
#include "app/files/fit_checks_json.hpp"
#include "model/files/one_line.hpp"
#include "fit/statistics/curve_error.hpp"
#include "model/density_curves.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

OrderedJson residual_to_json(const fit::TestResidual& r) {
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

fit::TestResidual residual_from_json(const Json& object) {
  fit::TestResidual r;
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

OrderedJson stage_to_json(const fit::Stage& stage) {
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
  for (const fit::Profile& profile : stage.profiles) profiles.push_back(profile_to_json(profile));
  OrderedJson& estimates = object["estimates"] = OrderedJson::object();
  for (const fit::NamedEstimate& named : stage.estimates) estimates[named.name] = chain::estimate_to_json(named.estimate);
  OrderedJson& tests = object["tests"] = OrderedJson::array();
  for (const fit::TestResidual& residual : stage.tests) tests.push_back(residual_to_json(residual));
  return object;
}

fit::Stage stage_from_json(const Json& object) {
  fit::Stage stage;
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
    stage.estimates.push_back({item.key(), chain::estimate_from_json(item.value())});
  for (const Json& residual : object.at("tests")) stage.tests.push_back(residual_from_json(residual));
  return stage;
}

// The numbers of a shear fit that are no estimates, under their JSON keys.
constexpr std::array<std::pair<const char*, double fit::ShearFit::*>, 13> kShearNumbers{{
    {"nu", &fit::ShearFit::nu},
    {"eps_dev_max", &fit::ShearFit::eps_dev_max},
    {"s_0", &fit::ShearFit::s_0},
    {"F_0", &fit::ShearFit::F_0},
    {"s_steady", &fit::ShearFit::s_steady},
    {"F_steady", &fit::ShearFit::F_steady},
    {"C_star", &fit::ShearFit::C_star},
    {"rattler_fraction", &fit::ShearFit::rattler_fraction},
    {"P_star", &fit::ShearFit::P_star},
    {"steady_from", &fit::ShearFit::steady_from},
    {"steady_since_s", &fit::ShearFit::steady_since_s},
    {"steady_since_F", &fit::ShearFit::steady_since_F},
    {"steady_since_P", &fit::ShearFit::steady_since_P},
}};
constexpr std::array<std::pair<const char*, fit::Estimate fit::ShearFit::*>, 4> kShearEstimates{{
    {"s_max", &fit::ShearFit::s_max},
    {"beta_s", &fit::ShearFit::beta_s},
    {"F_max", &fit::ShearFit::F_max},
    {"beta_F", &fit::ShearFit::beta_F},
}};

OrderedJson shear_to_json(const fit::ShearFit& shear) {
  OrderedJson object{{"test", shear.test}, {"mode", to_string(shear.mode)}, {"seed", shear.seed}};
  for (const auto& [key, member] : kShearNumbers) object[key] = number_or_null(shear.*member);
  for (const auto& [key, member] : kShearEstimates) object[key] = chain::estimate_to_json(shear.*member);
  return object;
}

fit::ShearFit shear_from_json(const Json& object) {
  fit::ShearFit shear;
  shear.test = object.at("test");
  shear.mode = value_of<Mode>(object.at("mode").get<std::string>(), "mode");
  shear.seed = object.at("seed");
  for (const auto& [key, member] : kShearNumbers) shear.*member = number_or_nan(object.at(key));
  for (const auto& [key, member] : kShearEstimates) shear.*member = chain::estimate_from_json(object.at(key));
  return shear;
}

/// Ours beside the published curves of `mode`; null where the data do not determine ours.
OrderedJson curves_to_json(const fit::Calibration& calibration, const std::string& mode) {
  OrderedJson curves = OrderedJson::array();
  for (const CurvePoint& point :
       curve_points(calibration.parameters, published_parameters(mode), calibration.nu_min, calibration.nu_max)) {
    const bool known = std::all_of(point.curve->groups.begin(), point.curve->groups.end(),
                                   [&](const char* group) { return fit::has_values(calibration, group); });
    const double error = known ? fit::standard_error(calibration, *point.curve, point.nu) : std::nan("");
    curves.push_back({{"quantity", point.curve->quantity},
                      {"nu", point.nu},
                      {"ours", known ? number_or_null(point.ours) : OrderedJson()},
                      {"standard_error", number_or_null(error)},
                      {"published", number_or_null(point.published)}});
  }
  return curves;
}

OrderedJson stages_to_json(const fit::Calibration& calibration) {
  OrderedJson stages = OrderedJson::array();
  for (const fit::Stage& stage : calibration.stages) stages.push_back(stage_to_json(stage));
  return stages;
}

OrderedJson shears_to_json(const fit::Calibration& calibration) {
  OrderedJson shear = OrderedJson::array();
  for (const fit::ShearFit& fit : calibration.shear) shear.push_back(shear_to_json(fit));
  return shear;
}

/// `object` holds "stages" and "shear".
void read_stages(const Json& object, fit::Calibration& calibration) {
  for (const Json& stage : object.at("stages")) calibration.stages.push_back(stage_from_json(stage));
  for (const Json& shear : object.at("shear")) calibration.shear.push_back(shear_from_json(shear));
}

OrderedJson description_to_json(const fit::Description& d) {
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

void write_calibration(const std::filesystem::path& file, const fit::Calibration& calibration,
                       const fit::CalibrationOptions& options, const ModeComparison& modes,
                       const std::string& dataset_digest, const OrderedJson& provenance) {
  OrderedJson document;
  document["format"] = "grainlaw calibration";
  document["format_version"] = 1;
  document["coupling"] = to_string(calibration.coupling);
  document["converged"] = calibration.converged;
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
  document["dataset_digest"] = dataset_digest;
  document["stages"] = stages_to_json(calibration);
  document["shear"] = shears_to_json(calibration);
  document["leave_one_out"] = left_out_to_json(calibration);
  document["curves"] = curves_to_json(calibration, "");
  OrderedJson& descriptions = document["descriptions"] = OrderedJson::array();
  for (const fit::Description& d : modes.descriptions) descriptions.push_back(description_to_json(d));
  OrderedJson& verdicts = document["verdicts"] = OrderedJson::array();
  for (const Verdict& v : modes.verdicts) verdicts.push_back(verdict_to_json(v));
  OrderedJson& claims = document["claims"] = OrderedJson::array();
  for (const Claim& claim : modes.claims) claims.push_back(claim_to_json(claim));
  document["unused_tests"] = calibration.unused_tests;
  document["warnings"] = calibration.warnings;
  document["provenance"] = provenance;
  write_json(file, document);
}

ModeComparison read_calibration(const std::filesystem::path& file, fit::Calibration& calibration) {
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

}  // namespace grainlaw::app
