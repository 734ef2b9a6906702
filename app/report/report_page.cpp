#include "app/report/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/dem_series.hpp"
#include "app/report/figures.hpp"
#include "app/report/number_text.hpp"
#include "app/report/tables.hpp"

namespace grainlaw::app::report {
namespace {

std::string folded(const std::string& summary, const std::string& html) {
  return "<details>\n<summary>" + to_html(plain(summary)) + "</summary>\n" + html + "\n</details>";
}

std::string warning_html(const std::string& text) { return "<p class=\"warning\">" + to_html(plain(text)) + "</p>"; }

std::vector<std::string> lead(const ReportInput& input) {
  const auto& calibration = input.calibration;
  const auto count = [&](Role role) {
    return std::count_if(input.tests.begin(), input.tests.end(),
                         [&](const TestRecord& test) { return test.role == role; });
  };
  std::string text = fmt::format(
      "Frictionless spheres in a periodic cell were compressed and sheared ({} calibration tests, {}); an "
      "incremental constitutive law was fitted to what they did; its predictions are set beside runs that the fit "
      "never saw. The form of the law and the published numbers are those of Imole, Kumar, Magnanimo and Luding, "
      "KONA 30 (2013).",
      count(Role::calibration), seed_count(input.tests));
  std::string reading = fmt::format(
      "In every figure symbols (or thin lines, where said) are DEM data, solid and dotted lines the law, dashed "
      "lines the published law. Stress is positive in compression, strain in tension; a star means multiplied by "
      "2⟨r⟩/k. Calibrated range: ν = {:.4g} to {:.4g}, deviatoric strain up to {:.3g}.",
      calibration.law.range.nu_min, calibration.law.range.nu_max, calibration.law.range.eps_dev_max);
  std::vector<std::string> blocks{paragraph_html(plain(text)), paragraph_html(plain(reading))};
  if (!calibration.law.converged) {
    std::string stages;
    for (const fit::Stage& stage : calibration.stages) {
      if (!stage.converged) stages += (stages.empty() ? "" : ", ") + stage.name;
    }
    blocks.push_back(warning_html("Not converged: " + stages + ". See the stages of the fit below."));
  }
  for (const std::string& warning : input.warnings) blocks.push_back(warning_html(warning));
  if (!input.run_warnings.empty()) {
    blocks.push_back(
        "<p class=\"warning\">" +
        to_html(plain(fmt::format("{} warnings came with the DEM runs (energy residual, inertial number or "
                                  "relaxation); they are listed under ",
                                  input.run_warnings.size()))) +
        "<a href=\"#quality\">the quality of the runs</a>.</p>");
  }
  return blocks;
}

/// The largest pressure misfit among the constant-volume tests of the coupled fit, in words.
std::string dilatancy_gap(const ReportInput& input) {
  const fit::TestResidual* worst = nullptr;
  for (const fit::Stage& stage : input.calibration.stages) {
    if (stage.name != "evolution") continue;
    for (const fit::TestResidual& residual : stage.tests) {
      const auto test = std::find_if(input.tests.begin(), input.tests.end(),
                                     [&](const TestRecord& t) { return t.name == residual.test; });
      if (residual.quantity != "P_star" || test == input.tests.end() || !is_pure_shear(*test)) continue;
      const auto relative = [](const fit::TestResidual& r) { return std::abs(r.bias) / r.max_abs_data; };
      if (worst == nullptr || relative(residual) > relative(*worst)) worst = &residual;
    }
  }
  if (worst == nullptr) return "No constant-volume test entered the coupled fit.";
  return fmt::format(
      "The known gap of Eq. 16: at constant volume the pressure of the packing changes, most of all near jamming, "
      "and the law has no dilatancy to follow it. The largest bias of P* is {}\u00a0% of the largest DEM value, in "
      "{}.",
      fixed(100 * worst->bias / worst->max_abs_data, 1), worst->test);
}

Section predictions(const ReportInput& input) {
  Section section{"predictions", "Predictions against runs that the fit never saw", {}};
  if (input.predictions.empty()) {
    section.blocks.push_back(paragraph_html(plain("None: the data do not identify all that a prediction needs.")));
    return section;
  }
  section.blocks.push_back(table_html(prediction_summary(input.predictions)));
  for (std::size_t i = 0; i < input.predictions.size(); ++i) {
    const predict::PredictionFolder& prediction = input.predictions[i];
    section.blocks.push_back(figure_html(prediction_figure(prediction, i)));
    std::vector<std::string> said;
    for (const predict::PredictedCurve& drawn : prediction.curves) {
      for (const std::string& warning : drawn.prediction.warnings) {
        if (std::find(said.begin(), said.end(), warning) != said.end()) continue;
        said.push_back(warning);
        section.blocks.push_back(warning_html(prediction.name + ": " + warning));
      }
    }
    section.blocks.push_back(folded(prediction.name + ": run by run", table_html(prediction_table(prediction))));
  }
  section.blocks.push_back(folded("Solver statistics", table_html(solver_table(input.predictions))));
  return section;
}

Section checks(const fit::Calibration& calibration) {
  Section section{"checks", "How far the fit can be trusted", {}};
  const Table left_out = left_out_table(calibration), profiles = profile_table(calibration);
  if (left_out.rows.empty() && profiles.rows.empty())
    section.blocks.push_back(
        paragraph_html(plain("Neither fits without one packing nor likelihood profiles were made.")));
  if (!left_out.rows.empty()) section.blocks.push_back(table_html(left_out));
  if (!profiles.rows.empty()) section.blocks.push_back(table_html(profiles));
  section.blocks.push_back(folded("Where shear is steady", table_html(steady_table(calibration))));
  return section;
}

}  // namespace

Page make_page(const ReportInput& input) {
  const auto& calibration = input.calibration;
  Page page;
  page.title = "From grains to a constitutive law";
  page.lead = lead(input);
  page.sections.push_back(
      {"parameters",
       "Parameters and curves",
       {table_html(parameter_comparison(calibration.law)),
        paragraph_html(
            plain("Parameters of Eqs. 11, 12 and 14 depend on each other: equal curves come from quite different "
                  "values. The curves are what should be compared.")),
        table_html(curve_comparison(calibration.law, CurveGroup::law)) +
            table_html(curve_comparison(calibration.law, CurveGroup::steady_state))}});
  if (!input.modes.verdicts.empty()) {
    page.sections.push_back(
        {"published",
         "Beside the published numbers, mode by mode",
         {table_html(jamming_table(input.modes.verdicts)),
          folded("Statements: which agree", table_html(claim_table(input.modes.claims))),
          folded("Curves: which agree", table_html(verdict_table(input.modes.verdicts, false))),
          folded("Parameters: which agree", table_html(verdict_table(input.modes.verdicts, true)))}});
  }
  page.sections.push_back({"state",
                           "Pressure, coordination and rattlers",
                           {figure_html(density_figure(input)), figure_html(scaled_density_figure(input)),
                            figure_html(modes_figure(input))}});
  page.sections.push_back({"shear",
                           "Stress ratio and fabric in shear",
                           {figure_html(stress_ratio_figure(input)), figure_html(fabric_figure(input))}});
  page.sections.push_back({"laws", "Shear parameters over density", {figure_html(shear_law_figure(input))}});
  page.sections.push_back(predictions(input));
  page.sections.push_back({"misfit",
                           "What the coupled fit leaves over",
                           {paragraph_html(plain(dilatancy_gap(input))), figure_html(residual_figure(input)),
                            folded("All numbers, test by test", table_html(residual_table(calibration))),
                            folded("Stages of the fit", table_html(stage_table(calibration)))}});
  page.sections.push_back(checks(calibration));
  std::string warnings;
  for (const std::string& warning : input.run_warnings) warnings += "<li>" + to_html(plain(warning)) + "</li>\n";
  if (warnings.empty()) warnings = "<li>none</li>\n";
  page.sections.push_back({"quality",
                           "How quasi-static and how exact the runs were",
                           {figure_html(preparation_quality_figure(input)), figure_html(shear_quality_figure(input)),
                            folded("Warnings of the runs", "<ul>\n" + warnings + "</ul>")}});
  page.sections.push_back(
      {"provenance",
       "Provenance and cost",
       {table_html(cost_table(input)), table_html(provenance_table(input)),
        folded("The resolved spec", table_html(spec_table(input))), folded("All runs", table_html(run_table(input)))}});
  return page;
}

}  // namespace grainlaw::app::report
