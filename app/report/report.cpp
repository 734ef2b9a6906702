#include "app/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/figure_data.hpp"
#include "app/report/figure_study.hpp"
#include "app/report/figures.hpp"
#include "app/report/first_screen.hpp"
#include "app/report/number_text.hpp"
#include "app/report/page.hpp"
#include "app/report/series.hpp"
#include "app/report/tables.hpp"
#include "app/report/warning_groups.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace report {
namespace {

Block open(BlockContent content) { return {{std::move(content)}}; }
Block folded(const std::string& summary, BlockContent content) { return {{std::move(content)}, summary}; }
Block text(const std::string& words) { return open(Paragraph{plain(words)}); }

/// What of the figure has data, or that none of it has.
Block drawn(const Figure& whole) {
  const Figure figure = with_data(whole);
  if (!figure.panels.empty()) return open(figure);
  return open(Paragraph{plain(whole.title + ": nothing to draw. ") + figure.caption});
}

constexpr const char* kReading =
    "Symbols and thin lines in figures are DEM data, thick lines the law, dashed lines the published law; form of the "
    "law and published numbers are those of Imole, Kumar, Magnanimo and Luding, KONA 30 (2013). Stress is positive in "
    "compression, strain in tension; a star means multiplied by 2⟨r⟩/k.";

/// The largest pressure misfit among the constant-volume tests of the coupled fit, in words.
std::string dilatancy_gap(const chain::ReportInput& input) {
  const auto relative = [](const fit::TestResidual& r) { return std::abs(r.bias) / r.max_abs_data; };
  const fit::TestResidual* worst = nullptr;
  for (const auto& [residual, test] : chain::coupled_misfits(input)) {
    if (residual.quantity != "P_star" || !is_pure_shear(test)) continue;
    if (worst == nullptr || relative(residual) > relative(*worst)) worst = &residual;
  }
  if (worst == nullptr) return "No constant-volume test entered the coupled fit.";
  return fmt::format(
      "The known gap of Eq. 16: at constant volume the pressure of the packing changes, most of all near jamming, and "
      "the law has no dilatancy to follow it. The largest bias of P* is {}\u00a0% of the largest DEM value, in {}.",
      fixed(100 * worst->bias / worst->max_abs_data, 1), worst->test);
}

Section predictions(const chain::ReportInput& input, const std::vector<chain::PathError>& errors) {
  Section section{"predictions", "Predictions against runs that the fit never saw", {}};
  if (!input.no_predictions.empty()) section.blocks.push_back(text(input.no_predictions));
  if (const Table table = unseen_table(errors, true, input.predictions); !table.rows.empty())
    section.blocks.push_back(open(table));
  if (const Table table = unseen_table(errors, false, input.predictions); !table.rows.empty())
    section.blocks.push_back(folded("Path by path: the rehearsals", table));
  for (std::size_t i = 0; i < input.predictions.size(); ++i) {
    const predict::PredictionFolder& prediction = input.predictions[i];
    Figure figure = prediction_figure(input, i);
    if (prediction.provenance.is_object()) figure.command = prediction.provenance.value("command", "");
    section.blocks.push_back(drawn(figure));
    if (const Table table = prediction_table(prediction); !table.rows.empty())  // compared with nothing: none
      section.blocks.push_back(folded(prediction.name + ": run by run", table));
  }
  if (!input.predictions.empty())
    section.blocks.push_back(folded("Solver statistics", solver_table(input.predictions)));
  return section;
}

Section checks(const fit::Calibration& calibration) {
  Section section{"checks", "How far the fit can be trusted", {}};
  for (const Table& table : {left_out_table(calibration), profile_table(calibration)}) {
    if (!table.rows.empty()) section.blocks.push_back(open(table));
  }
  if (section.blocks.empty())
    section.blocks.push_back(
        text("Neither fits without one packing nor likelihood profiles were made; grainlaw calibrate "
             "with --checks makes them."));
  section.blocks.push_back(folded("Where shear is steady", steady_table(calibration)));
  return section;
}

/// "74 agree, 47 differ of 191".
template <class Judged, class Keep>
std::string agreement(const std::vector<Judged>& all, const Keep& keep) {
  int agree = 0, differ = 0, of = 0;
  for (const Judged& judged : all) {
    if (!keep(judged)) continue;
    ++of;
    agree += judged.verdict == "agrees" ? 1 : 0;
    differ += judged.verdict == "differs" ? 1 : 0;
  }
  return fmt::format("{} agree, {} differ of {}", agree, differ, of);
}

/// Error against cost of the program's choices.
Section choices(const chain::ReportInput& input) {
  Section section{"choices", "What the program's choices cost", {}};
  for (const auto& [name, study] : input.studies) {
    Figure figure = figure_of(study);
    figure.id += "-" + std::to_string(section.blocks.size() + 1);
    figure.title = name + ": " + figure.title;
    figure.caption = plain(figure.description + ".");
    figure.sources = {"studies/" + name + "/study.json"};
    section.blocks.push_back(open(figure));
  }
  if (section.blocks.empty())
    section.blocks.push_back(
        text("No study of settings is in studies/. Error against cost of time step, strain rate, rows and packings is "
             "drawn here after: grainlaw study chain SPEC.json --for PATH.json --vary KEY=VALUE... -o "
             "DIR/studies/NAME, DIR the folder of this calibration."));
  return section;
}

Section parameters(const CalibratedLaw& law) {
  Section section{"parameters", "Parameters", {}};
  for (const Forest which : {Forest::densities, Forest::ratios, Forest::own}) {
    if (const Table table = forest(law, which); !table.rows.empty()) section.blocks.push_back(open(table));
  }
  section.blocks.push_back(
      text("Parameters of Eqs. 11, 12 and 14 depend on each other: equal curves come from quite different values. The "
           "curves are what should be compared."));
  section.blocks.push_back(folded("All parameters in numbers", parameter_comparison(law)));
  section.blocks.push_back({{curve_comparison(law, CurveGroup::law), curve_comparison(law, CurveGroup::steady_state)},
                            "Curves of the law at round densities"});
  return section;
}

/// Beside another calibration.
Section comparison(const chain::ReportInput& input, const std::vector<chain::PathError>& errors,
                   const chain::ReportInput& other, const std::string& name) {
  Section section{"comparison", "Beside " + name, {}};
  const std::vector<chain::PathError> errors_of_other = errors_on_unseen_paths(other);
  const Table both = error_pairs(errors, errors_of_other);
  section.blocks.push_back(both.rows.empty() ? text("No path that no fit saw is in both.") : open(both));
  if (const Table kinds = errors_by_kind(errors_of_other); !kinds.rows.empty()) {
    section.blocks.push_back(text(std::string("All unseen paths of the other") +
                                  (both.rows.empty() ? ":" : ", of which those above are a part:")));
    section.blocks.push_back(open(kinds));
  }
  section.blocks.push_back(open(parameter_pairs(input.calibration.law, other.calibration.law)));
  return section;
}

Page make_page(const chain::ReportInput& input, const chain::ReportInput* other, const std::string& name) {
  const auto& calibration = input.calibration;
  const fit::ModeComparison& modes = input.modes;
  const std::vector<chain::PathError> errors = errors_on_unseen_paths(input);
  const std::vector<WarningGroup> warnings = warning_groups(input);
  Page page{"From grains to a constitutive law", first_screen(input, errors), {}};
  const auto add = [&](const char* id, const char* heading, std::vector<Block> blocks) {
    page.sections.push_back({id, heading, std::move(blocks)});
  };
  if (other != nullptr) page.sections.push_back(comparison(input, errors, *other, name));
  page.sections.push_back(predictions(input, errors));
  // all figures but those of predictions and studies are made of what calibrate wrote
  const std::string command = fact_of(input, "command", "parameters.json");
  const auto of_calibrate = [&](Figure figure) {
    figure.command = command;
    return drawn(figure);
  };
  if (!modes.verdicts.empty()) {
    const std::string differs = fit::other_than_the_papers(input.tests);
    add("published", "Beside the published numbers, mode by mode",
        {text((differs.empty() ? ""
                               : fmt::format("The published numbers are of another material ({}): on none of "
                                             "them is there a verdict. ",
                                             differs)) +
              "Statements: " + agreement(modes.claims, [](auto&) { return true; }) +
              ". Points of curves: " + agreement(modes.verdicts, [](auto& v) { return v.nu.has_value(); }) +
              ". Parameters: " + agreement(modes.verdicts, [](auto& v) { return !v.nu; }) +
              (differs.empty()
                   ? ". The rest is undecided, most of it because its error is wider than what matters, or an identity."
                   : ". The rest is a number of the paper's, undecided, or an identity.")),
         open(jamming_table(modes.verdicts)), folded("Statements: which agree", claim_table(modes.claims)),
         folded("Curves: which agree", verdict_table(modes.verdicts, false)),
         folded("Parameters: which agree", verdict_table(modes.verdicts, true))});
  }
  page.sections.push_back(parameters(calibration.law));
  add("shear", "The law over the shear tests",
      {of_calibrate(sheared_pressure_figure(input)), of_calibrate(stress_ratio_figure(input)),
       of_calibrate(fabric_figure(input))});
  if (input.pictures) page.sections.back().blocks.push_back(open(packing_drawing(*input.pictures)));
  add("laws", "Shear parameters over density", {of_calibrate(shear_law_figure(input))});
  const auto folded_figure = [&](const std::string& summary, Figure figure) {
    Block block = of_calibrate(std::move(figure));
    block.summary = summary;
    return block;
  };
  add("state", "Pressure, coordination and rattlers",
      {of_calibrate(density_figure(input)),
       folded_figure("Scaled pressure, overlap and fabric trace", scaled_density_figure(input)),
       folded_figure("Mode by mode, as the paper draws them", modes_figure(input))});
  page.sections.push_back(choices(input));
  add("misfit", "What the coupled fit leaves over",
      {text(dilatancy_gap(input)), of_calibrate(residual_figure(input)),
       folded("All numbers, test by test", residual_table(calibration)),
       folded("Stages of the fit", stage_table(calibration))});
  page.sections.push_back(checks(calibration));
  add("quality", "How quasi-static and how exact the runs were",
      {text("What goes beyond a limit stands under Warnings, with what it costs."),
       folded_figure("Compression and decompression", preparation_quality_figure(input)),
       folded_figure("Element tests", shear_quality_figure(input))});
  if (warnings.empty())
    add("warnings", "Warnings", {text("None.")});
  else
    add("warnings", "Warnings", {open(warning_table(warnings))});
  std::vector<std::string> reasons;
  for (const Reservation& reason : reservations(input, errors)) reasons.push_back(reason.words);
  page.sections.back().blocks.push_back(folded("All reasons for distrust, weightiest first", Items{reasons}));
  add("provenance", "Provenance and cost",
      {text(kReading), open(cost_table(input)),
       folded("Files, commands, versions and seconds", provenance_table(input)),
       folded("The resolved spec", spec_table(input)), folded("All runs", run_table(input))});
  return page;
}

Page page_about(const std::filesystem::path& dir, const std::filesystem::path& compare) {
  const chain::ReportInput input = chain::read_report_input(dir);
  std::optional<chain::ReportInput> other;
  if (!compare.empty()) other = chain::read_report_input(compare);
  return make_page(input, other ? &*other : nullptr, compare.string());
}

}  // namespace
}  // namespace report

void write_report(const std::filesystem::path& dir, const std::filesystem::path& html,
                  const std::filesystem::path& compare) {
  const std::filesystem::path target = std::filesystem::weakly_canonical(html);  // through links
  if (std::filesystem::is_regular_file(target) && (target.extension() == ".json" || target.extension() == ".csv"))
    throw InvalidInput(
        fmt::format("{}: is there already and no page; give a name that ends with .html", html.string()));
  write_as_named(html, report::page_html(report::page_about(dir, compare)));
}

OrderedJson report_json(const std::filesystem::path& dir, const std::filesystem::path& compare) {
  return report::page_json(report::page_about(dir, compare));
}

std::string summary_table(const std::filesystem::path& dir) {
  return report::parameter_summary(chain::read_fitted_parameters(dir));
}

}  // namespace grainlaw::app
