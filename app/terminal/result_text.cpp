#include "app/terminal/result_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/report/report.hpp"
#include "model/files/fields_json.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

std::string advice_text(const predict::PredictionFolder& content) {
  std::string text = fmt::format("needs     {}: {}\n", to_string(content.needed.rung), content.needed.why) +
                     fmt::format("use       {}: {}\n", to_string(content.recommended.rung), content.recommended.why);
  for (const predict::RungChange& change : content.changes) {
    const predict::RungDifference& d = change.difference;
    text +=
        fmt::format("{} instead of {} changes P* by up to {:.1f} %, the stress ratio by {:.4f}, the fabric by {:.4f}\n",
                    to_string(change.richer), to_string(change.cheaper), 100 * d.P, d.s, d.F);
  }
  return text;
}

/// Whose rehearsals are in the bands, and the band of whole curves of the recommended rung.
std::string rehearsals_text(const predict::PredictionFolder& content) {
  if (!content.rehearsals) return "";
  const predict::PathRehearsals& said = *content.rehearsals;
  std::string text =
      fmt::format("rehearsed {} paths{}, m = {} degrees of freedom", said.paths,
                  said.of_kind ? fmt::format(" ({})", to_string(said.kind)) : " of all kinds", said.paths);
  for (const predict::RehearsedModel& model : said.models) {
    if (model.model != content.recommended.rung) continue;
    text += fmt::format("; {} as a whole within P* ±{:.2g}, s ±{:.2g}, F ±{:.2g} ({:.0f} %)", to_string(model.model),
                        model.P_star.whole_curve, model.s_par.whole_curve, model.F_par.whole_curve,
                        100 * said.whole_curve_probability);
  }
  text += "\n";
  if (!said.outside.empty()) text += fmt::format("          outside rehearsals: {}\n", fmt::join(said.outside, ", "));
  return text;
}

/// The bands at a row: half widths of the mean curve's and of a single run's.
std::string bands_text(const predict::PredictedRow& row) {
  if (!std::isfinite(row.mean.P)) return "";
  std::string text = fmt::format("{:<18}  ±", "");
  for (const auto& [name, band] : {std::pair{"P*", &predict::RowBand::P},
                                   {"s_par", &predict::RowBand::s_par},
                                   {"F_par", &predict::RowBand::F_par}}) {
    if (!std::isfinite(row.mean.*band)) continue;
    text += fmt::format("  {} {:.2g}", name, row.mean.*band);
    if (std::isfinite(row.single.*band)) text += fmt::format(" (single run {:.2g})", row.single.*band);
  }
  return text + "\n";
}

/// Shares of the DEM rows within the bands.
std::string coverage_text(const predict::Comparison& comparison) {
  std::string text;
  for (const auto& q : comparison.quantities) {
    if (!std::isfinite(q.coverage_mean)) continue;
    text += fmt::format("  {} {:.0f} %", q.quantity, 100 * q.coverage_mean);
    if (std::isfinite(q.coverage_single)) text += fmt::format(" (single run {:.0f} %)", 100 * q.coverage_single);
  }
  return text.empty() ? text : fmt::format("{:<18}  within the bands{}\n", "", text);
}

}  // namespace

std::string text_of(const dem::SimulationResult& simulation, const fs::path& output) {
  const OrderedJson& summary = simulation.summary;
  std::string text =
      fmt::format("{} spheres, {} rows, end of the {}:\n", summary.at("packing").at("particles").get<std::int64_t>(),
                  simulation.rows.size(), summary.contains("path") ? "path" : "unloading branch");
  for (const auto& value : summary.at("end").items()) {
    text += value.value().is_null() ? fmt::format("  {:<18} undefined\n", value.key())
                                    : fmt::format("  {:<18} {:.6g}\n", value.key(), value.value().get<double>());
  }
  return text + fmt::format("in {}\n", (output / "simulation.json").string());
}

std::string text_of(const chain::CalibrationResult& result, const fs::path& output, const Session& session) {
  return fmt::format("{}\n{} runs ({} found finished), {} tests, {:.1f} s, {:.0f} MB\n{}\n", summary_table(output),
                     result.counts.runs, result.counts.found, result.dataset.tests.size(), session.stopwatch.seconds(),
                     peak_memory_megabytes(), (output / "parameters.json").string());
}

OrderedJson summary_of(const chain::CalibrationResult& result, const fs::path& output, const Session& session) {
  return {{"folder", output.string()},
          {"parameters", (output / "parameters.json").string()},
          {"converged", result.calibration.law.converged},
          {"tests", result.dataset.tests.size()},
          {"runs", result.counts.runs},
          {"runs_found", result.counts.found},
          {"dataset_digest", result.dataset.digest},
          {"seconds", session.stopwatch.seconds()},
          {"peak_memory_MB", peak_memory_megabytes()}};
}

std::string text_of(const chain::TargetCalibration& calibration, const chain::PrecisionTarget& target,
                    const fs::path& output) {
  const chain::TargetRun& run = calibration.run;
  std::string text = fmt::format("{:>8} {:>9} {:>8} {:>5} {:>4} {:>6} {:>9} {:>9} {:>8}\n", "packings", "particles",
                                 "rate", "step", "nu", "strain", "seconds", "expected", "stated");
  for (const chain::TargetRound& r : run.rounds) {
    const chain::PlanSettings& s = r.settings;
    const auto percent = [](double x) { return std::isfinite(x) ? fmt::format("{:.2f}%", 100 * x) : "-"; };
    text += fmt::format("{:8} {:9} {:8.4g} {:5.2g} {:4} {:6.2g} {:9.1f} {:>9} {:>8}\n", s.packings, s.particles,
                        s.strain_rate, s.time_step_fraction, s.densities, s.shear_strain, r.seconds,
                        percent(r.expected_error), percent(r.error));
  }
  text += text_of(run.rounds.back()) + "\n";
  text += fmt::format("sheared at {}: the laws of shear are known there, beyond they are extrapolated\n",
                      fmt::join(calibration.planned.densities, ", "));
  return text + fmt::format("wanted {:.2f} %: {}\n{}\n", 100 * target.error, to_string(run.outcome),
                            (output / "parameters.json").string());
}

OrderedJson summary_of(const predict::PredictionFolder& content, const fs::path& output) {
  OrderedJson summary{{"folder", output.string()},
                      {"rung", rung_to_json(content)},
                      {"bands", content.bands},
                      {"rehearsals", content.rehearsals ? fields_to_json(*content.rehearsals) : OrderedJson(nullptr)},
                      {"warnings", content.warnings},
                      {"failures", fields_to_json(content.failures)}};
  OrderedJson& comparisons = summary["comparisons"] = OrderedJson::array();
  for (const predict::CurveComparison& entry : content.comparisons) {
    if (entry.seed) continue;
    OrderedJson object{{"model", to_string(entry.model)}, {"initial", to_string(entry.initial)}};
    for (const auto& q : entry.comparison.quantities) {
      object[q.quantity] = {{"bias", number_or_null(q.bias)},
                            {"normalised_rms", number_or_null(q.normalised_rms)},
                            {"coverage_mean", number_or_null(q.coverage_mean)},
                            {"coverage_single", number_or_null(q.coverage_single)}};
    }
    comparisons.push_back(object);
  }
  return summary;
}

std::string text_of(const predict::PredictionFolder& content, const fs::path& output) {
  std::string text = advice_text(content) + "bands     " + content.bands + "\n" + rehearsals_text(content);
  const auto recommended_first = [&](const auto& entry) { return entry.model != content.recommended.rung; };
  std::vector<predict::PredictedCurve> curves;
  for (const predict::PredictedCurve& curve : content.curves) {
    if (!curve.seed && !curve.prediction.rows.empty()) curves.push_back(curve);
  }
  std::ranges::stable_sort(curves, {}, recommended_first);
  for (const predict::PredictedCurve& curve : curves) {
    const predict::PredictedRow& end = curve.prediction.rows.back();
    text += fmt::format("{:<9} {:<8} end: nu {:.5f}  P* {:.6g}  s_par {:.5f}  F_par {:.5f}{}{}\n",
                        to_string(curve.model), to_string(curve.initial), end.nu, end.state.P, end.s_par, end.F_par,
                        curve.prediction.unjammed ? "  (unjammed)" : "",
                        curve.model == content.recommended.rung ? "  (recommended)" : "");
    text += bands_text(end);
  }
  for (const predict::FailedCurve& failed : content.failures) {
    if (!failed.seed)
      text += fmt::format("{:<9} {:<8} failed: {}\n", to_string(failed.model), to_string(failed.initial), failed.error);
  }
  std::vector<predict::CurveComparison> means;
  for (const predict::CurveComparison& entry : content.comparisons) {
    if (!entry.seed) means.push_back(entry);
  }
  std::ranges::stable_sort(means, {}, recommended_first);
  for (const predict::CurveComparison& entry : means) {
    text += fmt::format("{:<9} {:<8}", to_string(entry.model), to_string(entry.initial));
    for (const auto& q : entry.comparison.quantities)
      text += fmt::format("  {} bias {:+.4f} rms {:.1f} %", q.quantity, q.bias, 100 * q.normalised_rms);
    text += "\n" + coverage_text(entry.comparison);
  }
  return text + (output / "prediction.json").string() + "\n";
}

}  // namespace grainlaw::app
