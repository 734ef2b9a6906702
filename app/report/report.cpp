#include "app/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/figures.hpp"
#include "app/report/number_text.hpp"
#include "app/report/page.hpp"
#include "app/report/series.hpp"
#include "app/report/tables.hpp"
#include "model/files/output.hpp"

namespace grainlaw::app {
namespace report {
namespace {

Block open(BlockContent content) { return {{std::move(content)}}; }
Block folded(const std::string& summary, BlockContent content) { return {{std::move(content)}, summary}; }
Block text(const std::string& words) { return open(Paragraph{plain(words)}); }

std::vector<Block> lead(const chain::ReportInput& input) {
  const auto& calibration = input.calibration;
  const auto count = [&](Role role) {
    return std::count_if(input.tests.begin(), input.tests.end(),
                         [&](const TestRecord& test) { return test.role == role; });
  };
  const std::string subject = fmt::format(
      "Frictionless spheres in a periodic cell were compressed and sheared ({} calibration tests, {}); an "
      "incremental constitutive law was fitted to what they did; its predictions are set beside runs that the fit "
      "never saw. The form of the law and the published numbers are those of Imole, Kumar, Magnanimo and Luding, "
      "KONA 30 (2013).",
      count(Role::calibration), seed_count(input.tests));
  const std::string reading = fmt::format(
      "In every figure symbols (or thin lines, where said) are DEM data, solid and dotted lines the law, dashed "
      "lines the published law. Stress is positive in compression, strain in tension; a star means multiplied by "
      "2⟨r⟩/k. Calibrated range: ν = {:.4g} to {:.4g}, deviatoric strain up to {:.3g}.",
      calibration.law.range.nu_min, calibration.law.range.nu_max, calibration.law.range.eps_dev_max);
  std::vector<Block> blocks{text(subject), text(reading)};
  if (!calibration.law.converged) {
    std::string stages;
    for (const fit::Stage& stage : calibration.stages) {
      if (!stage.converged) stages += (stages.empty() ? "" : ", ") + stage.name;
    }
    blocks.push_back(open(Warning{"Not converged: " + stages + ". See the stages of the fit below."}));
  }
  for (const std::string& warning : input.warnings) blocks.push_back(open(Warning{warning}));
  if (!input.run_warnings.empty()) {
    blocks.push_back(open(Warning{
        fmt::format("{} warnings came with the DEM runs (energy residual, inertial number or relaxation); they are "
                    "listed under ",
                    input.run_warnings.size()),
        "quality", "the quality of the runs"}));
  }
  return blocks;
}

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
      "The known gap of Eq. 16: at constant volume the pressure of the packing changes, most of all near jamming, "
      "and the law has no dilatancy to follow it. The largest bias of P* is {}\u00a0% of the largest DEM value, in "
      "{}.",
      fixed(100 * worst->bias / worst->max_abs_data, 1), worst->test);
}

Section predictions(const chain::ReportInput& input) {
  Section section{"predictions", "Predictions against runs that the fit never saw", {}};
  if (input.predictions.empty()) {
    section.blocks = {text("None: the data do not identify all that a prediction needs.")};
    return section;
  }
  section.blocks = {open(prediction_summary(input.predictions))};
  for (std::size_t i = 0; i < input.predictions.size(); ++i) {
    const predict::PredictionFolder& prediction = input.predictions[i];
    section.blocks.push_back(open(prediction_figure(prediction, i)));
    std::vector<std::string> said;
    for (const std::string& warning : prediction.warnings)
      section.blocks.push_back(open(Warning{prediction.name + ": " + warning}));
    for (const predict::FailedCurve& failed : prediction.failures) {
      section.blocks.push_back(
          open(Warning{fmt::format("{}: {} is left out: {}", prediction.name, to_string(failed.model), failed.error)}));
    }
    for (const predict::PredictedCurve& drawn : prediction.curves) {
      for (const std::string& warning : drawn.prediction.warnings) {
        if (std::find(said.begin(), said.end(), warning) != said.end()) continue;
        said.push_back(warning);
        section.blocks.push_back(open(Warning{prediction.name + ": " + warning}));
      }
    }
    section.blocks.push_back(folded(prediction.name + ": run by run", prediction_table(prediction)));
  }
  section.blocks.push_back(folded("Solver statistics", solver_table(input.predictions)));
  return section;
}

Section checks(const fit::Calibration& calibration) {
  Section section{"checks", "How far the fit can be trusted", {}};
  for (const Table& table : {left_out_table(calibration), profile_table(calibration)}) {
    if (!table.rows.empty()) section.blocks.push_back(open(table));
  }
  if (section.blocks.empty())
    section.blocks.push_back(text("Neither fits without one packing nor likelihood profiles were made."));
  section.blocks.push_back(folded("Where shear is steady", steady_table(calibration)));
  return section;
}

Page make_page(const chain::ReportInput& input) {
  const auto& calibration = input.calibration;
  const fit::ModeComparison& modes = input.modes;
  Page page{"From grains to a constitutive law", lead(input), {}};
  const auto add = [&](const char* id, const char* heading, std::vector<Block> blocks) {
    page.sections.push_back({id, heading, std::move(blocks)});
  };
  add("parameters", "Parameters and curves",
      {open(parameter_comparison(calibration.law)),
       text("Parameters of Eqs. 11, 12 and 14 depend on each other: equal curves come from quite different values. The "
            "curves are what should be compared."),
       Block{{curve_comparison(calibration.law, CurveGroup::law),
              curve_comparison(calibration.law, CurveGroup::steady_state)}}});
  if (!modes.verdicts.empty()) {
    add("published", "Beside the published numbers, mode by mode",
        {open(jamming_table(modes.verdicts)), folded("Statements: which agree", claim_table(modes.claims)),
         folded("Curves: which agree", verdict_table(modes.verdicts, false)),
         folded("Parameters: which agree", verdict_table(modes.verdicts, true))});
  }
  add("state", "Pressure, coordination and rattlers",
      {open(density_figure(input)), open(scaled_density_figure(input)), open(modes_figure(input))});
  add("shear", "Stress ratio and fabric in shear", {open(stress_ratio_figure(input)), open(fabric_figure(input))});
  add("laws", "Shear parameters over density", {open(shear_law_figure(input))});
  page.sections.push_back(predictions(input));
  add("misfit", "What the coupled fit leaves over",
      {text(dilatancy_gap(input)), open(residual_figure(input)),
       folded("All numbers, test by test", residual_table(calibration)),
       folded("Stages of the fit", stage_table(calibration))});
  page.sections.push_back(checks(calibration));
  const std::vector<std::string> none{"none"};
  add("quality", "How quasi-static and how exact the runs were",
      {open(preparation_quality_figure(input)), open(shear_quality_figure(input)),
       folded("Warnings of the runs", Items{input.run_warnings.empty() ? none : input.run_warnings})});
  add("provenance", "Provenance and cost",
      {open(cost_table(input)), open(provenance_table(input)), folded("The resolved spec", spec_table(input)),
       folded("All runs", run_table(input))});
  return page;
}

}  // namespace
}  // namespace report

void write_report(const std::filesystem::path& dir, const std::filesystem::path& html) {
  write_durably(html, report::page_html(report::make_page(chain::read_report_input(dir))));
}

std::string summary_table(const std::filesystem::path& dir) {
  return report::parameter_summary(chain::read_fitted_parameters(dir));
}

}  // namespace grainlaw::app
