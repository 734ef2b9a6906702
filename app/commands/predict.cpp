#include "app/commands/predict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "model/parameters_file.hpp"
#include "dem/runs/new_packings.hpp"
#include "model/files/adopted_dataset.hpp"
#include "model/files/digest.hpp"
#include "model/files/output_folder.hpp"
#include "model/files/path_file.hpp"
#include "model/vocabulary/error.hpp"
#include "predict/bands.hpp"
#include "predict/mixed_control.hpp"
#include "predict/rung_advice.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

constexpr int kPointsPerSegment = 200;  // of a curve that no DEM run dictates

/// The rung that is asked for, else reduced, evolution, and memory where it is calibrated.
std::vector<Rung> rungs_of(const PredictOptions& options, const CalibratedLaw& law, const Path& path) {
  if (options.model) return {*options.model};
  std::vector<Rung> rungs{Rung::reduced, Rung::evolution};
  if (has_values(law, "memory")) rungs.push_back(Rung::memory);
  if (law_decides(path)) rungs.erase(rungs.begin());  // a closed form of the strain
  return rungs;
}

std::vector<predict::Initial> initials_of(const PredictOptions& options) {
  if (options.initial) return {*options.initial};
  const bool has_runs = options.dem || !options.against.empty();
  return has_runs ? std::vector{predict::Initial::law, predict::Initial::measured} : std::vector{predict::Initial::law};
}

/// The law with everything that a curve needs besides its start and its points.
struct Law {
  const CalibratedLaw& calibrated;
  std::vector<Rung> rungs;
  const Path& path;
  std::vector<StraightSegment> segments;  ///< none where the law decides where the path leads
  RunControl control;

  /// With bands, which take the start's error in where the law makes it.
  predict::Prediction along(Rung model, predict::Initial initial, const LawState<double>& start,
                            const std::vector<predict::OutputPoint>& points) const {
    return predict::predict_with_bands(model, calibrated, segments, start, initial == predict::Initial::law, points,
                                       control);
  }

  /// From the law's own start.
  predict::Prediction at_equal_steps(Rung model) const {
    const LawState<double> start = predict::state_from_law(calibrated.parameters, path.nu);
    if (!law_decides(path))
      return along(model, predict::Initial::law, start, predict::uniform_points(segments, kPointsPerSegment));
    return predict::predict_by_law(model, calibrated.parameters, calibrated.coupling, path, start, kPointsPerSegment,
                                   predict::Tolerances{}, calibrated.range, control);
  }
};

/// Curves at equal steps, from the law's own start.
void add_free_curves(const Law& law, predict::PredictionFolder& content) {
  for (const Rung model : law.rungs) {
    content.curves.push_back({model, predict::Initial::law, std::nullopt, fmt::format("{}-law.csv", to_string(model)),
                              law.at_equal_steps(model)});
  }
}

/// Curves at the rows of each DEM run, and how far they are from it.
void add_compared_curves(const Law& law, const PredictOptions& options, predict::PredictionFolder& content) {
  for (const DatasetTest& test : content.dem->tests) {
    const auto points = predict::points_of(test.record);
    const std::uint64_t seed = test.record.packing.seed;
    for (const Rung model : law.rungs) {
      for (const predict::Initial initial : initials_of(options)) {
        const auto start = initial == predict::Initial::law
                               ? predict::state_from_law(law.calibrated.parameters, content.path.nu)
                               : predict::state_from_row(test.record.rows.front());
        predict::PredictedCurve curve{model, initial, seed,
                                      fmt::format("{}-{}-s{}.csv", to_string(model), to_string(initial), seed),
                                      law.along(model, initial, start, points)};
        content.comparisons.push_back({model, initial, seed, predict::compare(curve.prediction, test.record)});
        content.curves.push_back(std::move(curve));
      }
    }
  }
  for (const predict::CurveComparison& mean : predict::mean_over_seeds(content.comparisons))
    content.comparisons.push_back(mean);
}

/// The runs of the path on new packings.
Dataset run_dem(const PredictOptions& options, const dem::Spec& spec, const PathFile& path, Session& session) {
  const std::string name = options.path.string();
  const auto tests = plan(spec, path, dem::new_seeds(spec, path, options.seeds, name), name);
  const fs::path parent = !options.store.empty()                 ? options.store
                          : options.parameters.has_parent_path() ? options.parameters.parent_path()
                                                                 : fs::path(".");
  make_output_folder(parent);
  dem::RunCounts counts;
  return dem::run_planned(tests, Json(dem::spec_to_json(spec)), make_subfolder(options.output, "dem"),
                          dem::RunStore(parent, "runs"), session, counts);
}

dem::Spec spec_beside(const PredictOptions& options) {
  const fs::path file = options.spec.empty() ? options.parameters.parent_path() / "spec.resolved.json" : options.spec;
  if (options.spec.empty() && !fs::exists(file)) {
    throw InvalidInput(fmt::format(
        "{}: not found; --dem prepares packings by the calibration's spec, give it with --spec", file.string()));
  }
  return dem::read_spec(file);
}

OrderedJson summary_of(const predict::PredictionFolder& content, const fs::path& output) {
  OrderedJson summary{{"folder", output.string()}, {"rung", rung_to_json(content)}, {"bands", content.bands}};
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

/// Which rung the path needs, and what each richer one changes on the curves from the law's start.
void add_advice(const Law& law, predict::PredictionFolder& content) {
  // where the law decides where the path leads, two rungs have no rows at the same strain
  if (law_decides(law.path)) {
    content.needed = {Rung::evolution, "the law decides the strain"};
    return;
  }
  content.needed = predict::rung_needed(law.calibrated.parameters, law.segments);
  const predict::PredictedCurve* cheaper = nullptr;
  for (const predict::PredictedCurve& curve : content.curves) {
    if (curve.seed) continue;
    if (cheaper != nullptr)
      content.changes.push_back(
          {cheaper->model, curve.model, predict::difference(cheaper->prediction, curve.prediction)});
    cheaper = &curve;
  }
}

std::string advice_text(const predict::PredictionFolder& content) {
  std::string text = fmt::format("needs     {}: {}\n", to_string(content.needed.rung), content.needed.why);
  for (const predict::RungChange& change : content.changes) {
    const predict::RungDifference& d = change.difference;
    text +=
        fmt::format("{} instead of {} changes P* by up to {:.1f} %, the stress ratio by {:.4f}, the fabric by {:.4f}\n",
                    to_string(change.richer), to_string(change.cheaper), 100 * d.P, d.s, d.F);
  }
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

std::string text_of(const predict::PredictionFolder& content, const fs::path& output) {
  std::string text = advice_text(content) + "bands     " + content.bands + "\n";
  for (const predict::PredictedCurve& curve : content.curves) {
    if (curve.seed || curve.prediction.rows.empty()) continue;
    const predict::PredictedRow& end = curve.prediction.rows.back();
    text += fmt::format("{:<9} {:<8} end: nu {:.5f}  P* {:.6g}  s_par {:.5f}  F_par {:.5f}{}\n", to_string(curve.model),
                        to_string(curve.initial), end.nu, end.state.P, end.s_par, end.F_par,
                        curve.prediction.unjammed ? "  (unjammed)" : "");
    text += bands_text(end);
  }
  for (const predict::CurveComparison& entry : content.comparisons) {
    if (entry.seed) continue;
    text += fmt::format("{:<9} {:<8}", to_string(entry.model), to_string(entry.initial));
    for (const auto& q : entry.comparison.quantities)
      text += fmt::format("  {} bias {:+.4f} rms {:.1f} %", q.quantity, q.bias, 100 * q.normalised_rms);
    text += "\n" + coverage_text(entry.comparison);
  }
  return text + (output / "prediction.json").string() + "\n";
}

}  // namespace

ExitCode run_prediction(const PredictOptions& options, Session& session) {
  if (options.initial == predict::Initial::measured && !options.dem && options.against.empty()) {
    throw InvalidInput("predict: --initial measured starts from the values of a packing; give --dem or --against too");
  }
  const CalibratedLaw calibrated = read_parameters(options.parameters).law;
  const PathFile path = read_path(options.path);
  const std::vector<Rung> rungs = rungs_of(options, calibrated, path.path);
  if (law_decides(path.path) && rungs.front() == Rung::reduced) {
    throw InvalidInput(
        fmt::format("{}: segments: leave the strain to the law; the reduced one is a closed form of the strain, give "
                    "--model evolution",
                    options.path.string()));
  }
  for (const Rung model : rungs) require_parameters(calibrated, model, options.parameters.string());
  const Law law{calibrated,
                rungs,
                path.path,
                law_decides(path.path) ? std::vector<StraightSegment>{} : resolve(path.path),
                {{}, session.stop}};
  predict::state_from_law(calibrated.parameters,
                          path.path.nu);  // refuses a start below jamming before anything is written
  std::optional<dem::Spec> spec;
  if (options.dem) {
    spec = spec_beside(options);
    plan(*spec, path, dem::new_seeds(*spec, path, options.seeds, options.path.string()), options.path.string());
  }

  std::optional<Dataset> finished;
  fs::path from;
  if (!options.against.empty()) {
    from = dataset_folder(options.against);
    finished = read_dataset(from);
    require_runs_of(path.path, *finished, from.string());
  }

  make_output_folder(options.output);
  predict::PredictionFolder content;
  content.name = options.output.filename().string();
  content.path = path.path;
  content.parameters = {{"file", options.parameters.string()},
                        {"sha256", sha256_of_file(options.parameters)},
                        {"dataset_digest", calibrated.dataset_digest}};
  if (options.dem) content.dem = run_dem(options, *spec, path, session);
  if (finished) content.dem = adopt(*finished, from, make_subfolder(options.output, "dem"));
  if (options.initial != predict::Initial::measured) add_free_curves(law, content);
  if (content.dem) add_compared_curves(law, options, content);
  add_advice(law, content);
  content.bands = law_decides(path.path) ? "none: the law decides the strain" : available_bands(calibrated);
  content.provenance = Json(provenance(session));
  predict::write_prediction(options.output, content);

  std::set<std::string> warned;
  if (!calibrated.converged) session.watch.log("warning: the calibration did not converge");
  for (const predict::PredictedCurve& curve : content.curves) {
    for (const std::string& warning : curve.prediction.warnings) {
      if (warned.insert(warning).second) session.watch.log("warning: " + warning);
    }
  }
  print_result(session.json ? json_text(summary_of(content, options.output)) : text_of(content, options.output));
  return ExitCode::ok;
}

}  // namespace grainlaw::app
