#include "app/terminal/result_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "app/report/report.hpp"
#include "app/terminal/help.hpp"
#include "fit/published/verdicts.hpp"
#include "model/files/fields_json.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWidth = 80;

/// A paragraph beside its word: "needs     memory: ...".
std::string paragraph(const std::string& word, const std::string& text) {
  std::string lines;
  for (const std::string& line : wrapped(text, kWidth - 10))
    lines += fmt::format("{:<9} {}\n", lines.empty() ? word : "", line);
  return lines;
}

std::string advice_text(const predict::PredictionFolder& content) {
  std::string text =
      paragraph("needs", fmt::format("{}: {}", to_string(content.needed.rung), content.needed.why)) +
      paragraph("use", fmt::format("{}: {}", to_string(content.recommended.rung), content.recommended.why));
  for (const predict::RungChange& change : content.changes) {
    const predict::RungDifference& d = change.difference;
    text += paragraph("changes",
                      fmt::format("{} instead of {}: P* by up to {:.1f} %, the stress ratio by {:.4f}, the fabric by "
                                  "{:.4f}",
                                  to_string(change.richer), to_string(change.cheaper), 100 * d.P, d.s, d.F));
  }
  return text + paragraph("bands", content.bands);
}

/// Whose rehearsals are in the bands, and the band of whole curves of the recommended rung.
std::string rehearsals_text(const predict::PredictionFolder& content) {
  if (!content.rehearsals) return "";
  const predict::PathRehearsals& said = *content.rehearsals;
  std::string text = fmt::format("{} {}{}, m = {} {} of freedom", said.paths, said.paths == 1 ? "path" : "paths",
                                 said.of_kind ? fmt::format(" ({})", to_string(said.kind)) : " of all kinds",
                                 said.paths, said.paths == 1 ? "degree" : "degrees");
  for (const predict::RehearsedModel& model : said.models) {
    if (model.model != content.recommended.rung) continue;
    std::vector<std::string> within;
    for (const auto& [name, error] : {std::pair{"P*", &model.P_star}, {"s", &model.s_par}, {"F", &model.F_par}}) {
      if (std::isfinite(error->whole_curve)) within.push_back(fmt::format("{} ±{:.2g}", name, error->whole_curve));
    }
    text += fmt::format("; {} as a whole within {} ({:.0f} %)", to_string(model.model), fmt::join(within, ", "),
                        100 * said.whole_curve_probability);
  }
  text = paragraph("rehearsed", text);
  if (said.outside.empty()) return text;
  return text + paragraph("", fmt::format("outside rehearsals: {}", fmt::join(said.outside, ", ")));
}

/// The end of a curve with the half widths of the bands of the mean, and those of a single run below.
std::string end_text(const predict::PredictedCurve& curve, bool recommended) {
  const predict::PredictedRow& end = curve.prediction.rows.back();
  const auto value = [](double x, double half_width) {
    if (std::isnan(x)) return std::string("-");
    return std::isfinite(half_width) ? fmt::format("{:.4g} ± {:.2g}", x, half_width) : fmt::format("{:.4g}", x);
  };
  const auto half = [](double x) { return std::isfinite(x) ? fmt::format("± {:.2g}", x) : std::string(); };
  std::string text =
      fmt::format("{:<9} {:<10} {:<9.5f} {:<17} {:<15} {}\n", to_string(curve.model), to_string(curve.initial), end.nu,
                  value(end.state.P, end.mean.P), value(end.s_par, end.mean.s_par), value(end.F_par, end.mean.F_par));
  if (std::isfinite(end.single.P))
    text += fmt::format("{:<9} {:<20} {:<17} {:<15} {}\n", "", "single run", half(end.single.P), half(end.single.s_par),
                        half(end.single.F_par));
  if (recommended) text += fmt::format("{:<9} recommended\n", "");
  if (!curve.prediction.unjammed) return text;
  return text + (end.state.P > 0 ? fmt::format("{:<9} unjammed on the way, jammed again\n", "")
                                 : fmt::format("{:<9} unjammed\n", ""));
}

/// How far a curve is from the runs: a line for each quantity.
std::string comparison_text(const predict::CurveComparison& entry) {
  std::string text, model = to_string(entry.model), initial = to_string(entry.initial);
  const auto share = [](double x) { return std::isfinite(x) ? fmt::format("{:.0f} %", 100 * x) : std::string(); };
  for (const auto& q : entry.comparison.quantities) {
    if (q.rows == 0) continue;  // the law or the runs do not tell it
    const std::string bias = std::abs(q.bias) < 1e-4 ? fmt::format("{:+.1g}", q.bias) : fmt::format("{:+.4f}", q.bias);
    text += fmt::format("{:<9} {:<10} {:<8} {:>9} {:>8.1f} % {:>12} {:>12}\n", std::exchange(model, ""),
                        std::exchange(initial, ""), q.quantity, bias, 100 * q.normalised_rms, share(q.coverage_mean),
                        share(q.coverage_single));
  }
  return text;
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
  const std::string other = fit::other_than_the_papers(tests_of(result.dataset, Role::calibration));
  return fmt::format("{}{}\n{} runs ({} found finished), {} tests, {:.1f} s, {:.0f} MB\n{}\n", summary_table(output),
                     other.empty() ? "" : paragraph("published", "of another material: " + other), result.counts.runs,
                     result.counts.found, result.dataset.tests.size(), session.stopwatch.seconds(),
                     peak_memory_megabytes(), (output / "parameters.json").string());
}

OrderedJson summary_of(const chain::CalibrationResult& result, const fs::path& output, const Session& session) {
  return {{"folder", output.string()},
          {"parameters", (output / "parameters.json").string()},
          {"converged", result.calibration.law.converged},
          {"tests", result.dataset.tests.size()},
          {"runs", result.counts.runs},
          {"runs_found", result.counts.found},
          {"runs_of_others", result.counts.others},
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
  text += paragraph("reached", text_of(run.rounds.back()));
  text += paragraph("sheared", fmt::format("at {}: the laws of shear are known there, beyond they are extrapolated",
                                           fmt::join(calibration.planned.densities, ", ")));
  return text + fmt::format("wanted {:.2f} %: {}\n{}\n", 100 * target.error, to_string(run.outcome),
                            (output / "parameters.json").string());
}

namespace {

/// Of the curves that are no run's: where they end, with half widths, and what is to be said of them.
OrderedJson ends_to_json(const predict::PredictionFolder& content) {
  OrderedJson ends = OrderedJson::array();
  for (const predict::PredictedCurve& curve : content.curves) {
    if (curve.seed || curve.prediction.rows.empty()) continue;
    const predict::PredictedRow& end = curve.prediction.rows.back();
    const auto value = [](double x, double mean, double single) {
      return OrderedJson{
          {"value", number_or_null(x)}, {"mean95", number_or_null(mean)}, {"single95", number_or_null(single)}};
    };
    ends.push_back({{"model", to_string(curve.model)},
                    {"initial", to_string(curve.initial)},
                    {"nu", end.nu},
                    {"P_star", value(end.state.P, end.mean.P, end.single.P)},
                    {"s_par", value(end.s_par, end.mean.s_par, end.single.s_par)},
                    {"F_par", value(end.F_par, end.mean.F_par, end.single.F_par)},
                    {"unjammed", curve.prediction.unjammed},
                    {"warnings", curve.prediction.warnings}});
  }
  return ends;
}

}  // namespace

OrderedJson summary_of(const predict::PredictionFolder& content, const fs::path& output) {
  OrderedJson summary{{"folder", output.string()},
                      {"rung", rung_to_json(content)},
                      {"bands", content.bands},
                      {"rehearsals", content.rehearsals ? fields_to_json(*content.rehearsals) : OrderedJson(nullptr)},
                      {"warnings", content.warnings},
                      {"failures", fields_to_json(content.failures)},
                      {"ends", ends_to_json(content)}};
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
  std::string text = advice_text(content) + rehearsals_text(content);
  const auto recommended_first = [&](const auto& entry) { return entry.model != content.recommended.rung; };
  std::vector<predict::PredictedCurve> curves;
  for (const predict::PredictedCurve& curve : content.curves) {
    if (!curve.seed && !curve.prediction.rows.empty()) curves.push_back(curve);
  }
  std::ranges::stable_sort(curves, {}, recommended_first);
  if (!curves.empty())
    text += fmt::format("\nThe end of the path, with 95 % bands\n{:<9} {:<10} {:<9} {:<17} {:<15} {}\n", "rung",
                        "start", "nu", "P*", "s_par", "F_par");
  for (const predict::PredictedCurve& curve : curves) text += end_text(curve, curve.model == content.recommended.rung);
  for (const predict::FailedCurve& failed : content.failures) {
    if (!failed.seed)
      text += paragraph(to_string(failed.model), fmt::format("{} failed: {}", to_string(failed.initial), failed.error));
  }
  std::vector<predict::CurveComparison> means;
  for (const predict::CurveComparison& entry : content.comparisons) {
    if (!entry.seed) means.push_back(entry);
  }
  std::ranges::stable_sort(means, {}, recommended_first);
  if (!means.empty())
    text += fmt::format(
        "\nFrom the DEM runs, mean over seeds; shares of rows within the bands\n{:<9} {:<10} {:<8} {:>9} {:>10} "
        "{:>12} {:>12}\n",
        "rung", "start", "quantity", "bias", "rms", "mean", "single run");
  for (const predict::CurveComparison& entry : means) text += comparison_text(entry);
  return text + "\n" + (output / "prediction.json").string() + "\n";
}

}  // namespace grainlaw::app
