#include "app/commands/study_dem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/dataset_runs.hpp"
#include "app/output_folder.hpp"
#include "app/provenance.hpp"
#include "app/report/svg_file.hpp"
#include "app/settings_study.hpp"
#include "model/error.hpp"

namespace grainlaw::app {
namespace {

std::vector<Setting> settings_of(const StudyDemOptions& options, const Spec& base) {
  Changes reference;
  for (const std::string& text : options.reference) reference.push_back(change_from(text));
  std::vector<Setting> settings{setting_of("reference", base, reference), setting_of("base", base, {})};
  for (const std::string& text : options.vary) settings.push_back(setting_of(text, base, {change_from(text)}));
  for (const Setting& setting : settings) {
    if (setting.spec.seeds != base.seeds)
      throw InvalidInput(
          fmt::format("{}: seeds are what settings are compared over; leave them as they are", setting.name));
    if (!is_safe_name("s-" + setting.name.substr(setting.name.find('=') + 1)))
      throw InvalidInput(fmt::format("{}: its value cannot be part of a file's name", setting.name));
  }
  if (base.seeds.size() < 2) throw InvalidInput("study dem: seeds: one packing has no scatter; give two or more");
  return settings;
}

OrderedJson changes_to_json(const Changes& changes) {
  OrderedJson object = OrderedJson::object();
  for (const auto& [key, value] : changes) object[key] = value;
  return object;
}

OrderedJson result_to_json(const SettingResult& r) {
  OrderedJson object{{"setting", r.setting.name},
                     {"changes", changes_to_json(r.setting.changes)},
                     {"particle_steps", r.particle_steps},
                     {"seconds", r.seconds},
                     {"error", number_or_null(r.error)},
                     {"floor", number_or_null(r.floor)},
                     {"dominated", r.dominated}};
  OrderedJson& quantities = object["quantities"] = OrderedJson::array();
  for (const QuantityError& e : r.errors) {
    quantities.push_back({{"quantity", e.quantity},
                          {"value", number_or_null(e.value)},
                          {"error", number_or_null(e.error)},
                          {"standard_error", number_or_null(e.standard_error)}});
  }
  return object;
}

/// One point with its label.
report::Series point_of(const SettingResult& r, const std::string& label, report::Colour colour,
                        report::Marker marker) {
  report::Series series;
  series.label = report::plain(label);
  series.x = {r.particle_steps};
  series.y = {std::max(r.error, r.floor)};
  series.colour = colour;
  series.marker = marker;
  series.marker_size = 4;
  series.open_marker = r.dominated;
  return series;
}

report::Figure figure_of(const std::vector<SettingResult>& results) {
  using namespace report;
  Figure figure;
  figure.id = "settings";
  figure.title = "Error of settings against their cost";
  figure.description =
      "Root mean square of the relative errors of P*, C*, s_max, beta_s, F_max and beta_F over particle-steps; "
      "outlined: "
      "dominated; dotted: what scatter alone makes";
  figure.panel_height = 380;
  Panel panel;
  panel.x.label = plain("particle-steps");
  panel.y.label = plain("relative error, or its floor where that is larger [–]");
  panel.x.logarithmic = panel.y.logarithmic = true;
  Series floor;
  floor.label = plain("floor: scatter over the packings");
  floor.line = Line::dotted;
  std::vector<const SettingResult*> by_cost;
  for (std::size_t i = 1; i < results.size(); ++i) by_cost.push_back(&results[i]);
  std::sort(by_cost.begin(), by_cost.end(),
            [](const auto* a, const auto* b) { return a->particle_steps < b->particle_steps; });
  for (const SettingResult* r : by_cost) {
    floor.x.push_back(r->particle_steps);
    floor.y.push_back(r->floor);
  }
  panel.series.push_back(floor);
  panel.series.push_back(point_of(results[1], "base", Colour::vermillion, Marker::cross));
  for (std::size_t i = 2; i < results.size(); ++i) {
    const std::string& name = results[i].setting.name;
    const auto marker = static_cast<Marker>(1 + i % 4);
    panel.series.push_back(point_of(results[i], name, results[i].dominated ? Colour::ink : Colour::blue, marker));
  }
  figure.panels.push_back(panel);
  return figure;
}

std::string text_of(const std::vector<SettingResult>& results, const std::filesystem::path& file) {
  std::string text =
      fmt::format("{:<28} {:>14} {:>9} {:>9} {:>9}\n", "setting", "particle-steps", "seconds", "error", "floor");
  for (const SettingResult& r : results) {
    text += fmt::format("{:<28} {:14.3e} {:9.1f} {:8.2f}% {:8.2f}%{}\n", r.setting.name, r.particle_steps, r.seconds,
                        100 * r.error, 100 * r.floor, r.dominated ? "  dominated" : "");
  }
  return text + file.string() + "\n";
}

}  // namespace

ExitCode study_dem(const StudyDemOptions& options, Session& session) {
  const Spec base = read_spec(options.spec);
  const std::vector<Setting> settings = settings_of(options, base);
  make_output_folder(options.output);
  const std::filesystem::path data = make_subfolder(options.output, "data");
  std::vector<SettingResult> results;
  std::optional<Dataset> reference;
  for (const Setting& setting : settings) {
    session.progress.log("setting " + setting.name);
    RunCounts counts;
    std::string folder = setting.name;
    std::replace(folder.begin(), folder.end(), '=', '-');
    const Dataset dataset =
        run_planned(plan(setting.spec), Json(spec_to_json(setting.spec)), make_subfolder(data, folder),
                    RunStore(options.output, "runs"), session, counts);
    if (!reference) reference = dataset;
    results.push_back(compare_setting(setting, dataset, *reference));
  }
  find_dominated(results);

  OrderedJson document{{"format", "grainlaw study"}, {"format_version", 1}, {"study", "dem"}};
  document["base"] = spec_to_json(base);
  document["packings"] = base.seeds.size();
  document["error"] =
      "root mean square over P_star, C_star, s_max, beta_s, F_max, beta_F at the densities of shear of the relative "
      "difference from the reference, mean over packings; floor: likewise of its standard error";
  OrderedJson& all = document["settings"] = OrderedJson::array();
  for (const SettingResult& r : results) all.push_back(result_to_json(r));
  document["provenance"] = provenance(session.command, session.threads, session.stopwatch);
  write_json(options.output / "study.json", document);
  report::write_svg(options.output / "settings.svg", figure_of(results));
  print_result(session.json ? json_text(document) : text_of(results, options.output / "study.json"));
  return ExitCode::ok;
}

}  // namespace grainlaw::app
