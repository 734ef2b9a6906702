#include "chain/prediction.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "chain/rehearsals.hpp"
#include "dem/runs/dataset_runs.hpp"
#include "model/files/dataset.hpp"
#include "model/files/digest.hpp"
#include "model/files/output.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"
#include "predict/bands.hpp"
#include "predict/compare.hpp"
#include "predict/mixed_control.hpp"
#include "predict/rung_advice.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

using predict::Initial;

/// The rung that is asked for, else those that are calibrated; where there is none, the first, which is refused by what it lacks.
std::vector<Rung> rungs_of(const PredictionInput& input) {
  const bool decides = law_decides(input.path.path);
  if (input.model) {
    if (decides && *input.model == Rung::reduced) {
      throw InvalidInput(
          fmt::format("{}: segments: leave the strain to the law; the reduced one is a closed form of the strain, give "
                      "--model evolution",
                      input.path_name));
    }
    return {*input.model};
  }
  std::vector<Rung> rungs = calibrated_rungs(input.law);
  if (decides) std::erase(rungs, Rung::reduced);  // a closed form of the strain
  if (rungs.empty()) rungs = {decides ? Rung::evolution : Rung::reduced};
  return rungs;
}

std::vector<Initial> initials_of(const PredictionInput& input) {
  if (input.initial) return {*input.initial};
  return {Initial::law, Initial::measured};
}

/// The law with everything that a curve needs besides its start and its points.
struct Law {
  const CalibratedLaw& calibrated;
  std::vector<Rung> rungs;
  const Path& path;
  std::vector<StraightSegment> segments;  ///< none where the law decides where the path leads
  RunControl control;

  /// With bands, which take the start's error in where the law makes it.
  predict::Prediction along(Rung model, Initial initial, const LawState<double>& start,
                            const std::vector<predict::OutputPoint>& points) const {
    return predict::predict_with_bands(model, calibrated, segments, start, initial == Initial::law, points, control);
  }

  /// From the law's own start.
  predict::Prediction at_equal_steps(Rung model) const {
    const LawState<double> start = predict::state_from_law(calibrated.parameters, path.nu);
    if (!law_decides(path)) return along(model, Initial::law, start, predict::uniform_points(segments));
    return predict::predict_by_law(model, calibrated.parameters, calibrated.coupling, path, start,
                                   predict::kCurvePoints, predict::Tolerances{}, calibrated.range, control);
  }
};

/// `curve.prediction` by `predicted`; false, with an entry in the failures, where the law does not converge: one rung must
/// not take the others with it.
bool add_curve(predict::PredictedCurve curve, const std::function<predict::Prediction()>& predicted,
               predict::PredictionFolder& content) {
  try {
    curve.prediction = predicted();
  } catch (const NotConverged& error) {
    content.failures.push_back({curve.model, curve.initial, curve.seed, error.what()});
    return false;
  }
  content.curves.push_back(std::move(curve));
  return true;
}

/// What `start` gives; its refusal under the name of the file, key or row that it came from.
template <class Start>
auto named(const std::string& name, const Start& start) {
  try {
    return start();
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
}

/// The values measured in the first row of a run.
LawState<double> measured_start(const TestRecord& test) {
  return named(fmt::format("{}.csv: row 1, column 'P_star'", test.name),
               [&] { return predict::state_from_row(test.rows.front()); });
}

/// Refuses a start below jamming, before anything is written.
void check_starts(const PredictionInput& input) {
  named(input.path_name + ": initial.nu",
        [&] { return predict::state_from_law(input.law.parameters, input.path.path.nu); });
  if (!input.finished_runs || input.initial == Initial::law) return;
  for (const DatasetTest& test : input.finished_runs->dataset.tests) measured_start(test.record);
}

/// Curves at equal steps, from the law's own start.
void add_free_curves(const Law& law, predict::PredictionFolder& content) {
  for (const Rung model : law.rungs) {
    add_curve(
        {model, Initial::law, std::nullopt, fmt::format("{}-law.csv", to_string(model)), {}},
        [&] { return law.at_equal_steps(model); }, content);
  }
}

/// Curves at the rows of each DEM run, and how far they are from it.
void add_compared_curves(const Law& law, const PredictionInput& input, predict::PredictionFolder& content) {
  for (const DatasetTest& test : content.dem->tests) {
    const auto points = predict::points_of(test.record);
    const std::uint64_t seed = test.record.packing.seed;
    for (const Rung model : law.rungs) {
      for (const Initial initial : initials_of(input)) {
        if (initial == Initial::measured && model != Rung::reduced &&
            !test.record.rows.front().fabric.tensor.allFinite()) {
          content.failures.push_back(
              {model, initial, seed,
               "the run tells no fabric, which this rung starts from; --initial law does without it"});
          continue;
        }
        const auto start = initial == Initial::law ? predict::state_from_law(law.calibrated.parameters, content.path.nu)
                                                   : measured_start(test.record);
        const bool added = add_curve(
            {model, initial, seed, fmt::format("{}-{}-s{}.csv", to_string(model), to_string(initial), seed), {}},
            [&] { return law.along(model, initial, start, points); }, content);
        if (added)
          content.comparisons.push_back(
              {model, initial, seed, predict::compare(content.curves.back().prediction, test.record)});
      }
    }
  }
  for (const predict::CurveComparison& mean : predict::mean_over_seeds(content.comparisons))
    content.comparisons.push_back(mean);
}

/// Throws NotConverged with the first failure where no curve is left.
void require_a_curve(const predict::PredictionFolder& content) {
  if (content.curves.empty() && !content.failures.empty()) throw NotConverged(content.failures.front().error);
}

/// Which rung the path needs, and what each richer one changes on the curves from the law's start.
void add_advice(const Law& law, predict::PredictionFolder& content) {
  std::vector<Rung> rungs = law.rungs;
  std::erase_if(rungs, [&](Rung rung) {
    return std::ranges::find(content.curves, rung, &predict::PredictedCurve::model) == content.curves.end();
  });
  if (rungs.empty()) rungs = law.rungs;  // all failed
  // where the law decides where the path leads, two rungs have no rows at the same strain
  if (law_decides(law.path)) {
    content.needed = {Rung::evolution, "the law decides the strain"};
    content.recommended = {rungs.back(), false, "the richest; where the law decides the strain none is rehearsed"};
    return;
  }
  content.needed = predict::rung_needed(law.calibrated.parameters, law.segments);
  const auto recommended_of = [&](const std::vector<Rung>& choice) {
    return predict::recommended_rung(law.calibrated.rehearsals, law.segments, choice, content.needed);
  };
  content.recommended = recommended_of(rungs);
  if (const Rung better = recommended_of(law.rungs).rung; better != content.recommended.rung)
    content.recommended.why += fmt::format("; of all rungs it would be {}, which has no curve here", to_string(better));
  const predict::PredictedCurve* cheaper = nullptr;
  for (const predict::PredictedCurve& curve : content.curves) {
    if (curve.seed) continue;
    if (cheaper != nullptr)
      content.changes.push_back(
          {cheaper->model, curve.model, predict::difference(cheaper->prediction, curve.prediction)});
    cheaper = &curve;
  }
}

/// What rehearsals say of the rungs along the path, and where it goes beyond them.
void add_rehearsals(const Law& law, predict::PredictionFolder& content) {
  const Spokesmen spokesmen = spokesmen_for(law.segments, law.calibrated.rehearsals);
  if (law_decides(law.path) || spokesmen.rehearsals.empty()) return;
  const double m = static_cast<double>(spokesmen.rehearsals.size());
  predict::PathRehearsals& said = content.rehearsals.emplace();
  said.kind = spokesmen.kind;
  said.paths = static_cast<int>(spokesmen.rehearsals.size());
  said.of_kind = spokesmen.of_kind;
  said.outside = ways_outside(traits_of(law.segments), spokesmen);
  said.whole_curve_probability = m / (m + 1);
  for (const Rung rung : law.rungs) {
    const auto of = [&](Rehearsed quantity) {
      predict::RehearsedError said_of{law_error(spokesmen, rung, quantity), 0};
      double widest = 0;
      for (const predict::PredictedCurve& curve : content.curves) {
        for (const predict::PredictedRow& row : curve.prediction.rows)
          widest = std::max(widest, error_units(law.calibrated.parameters, row.nu).of(quantity));
      }
      said_of.whole_curve = widest * said_of.error.largest;
      return said_of;
    };
    said.models.push_back({rung, of(Rehearsed::P_star), of(Rehearsed::s_par), of(Rehearsed::F_par)});
  }
}

void add_warnings(const PredictionInput& input, predict::PredictionFolder& content) {
  content.warnings = warnings_along(input.law, input.path);
  if (!input.model) {
    for (std::string& line : left_out_rungs(input.law)) content.warnings.push_back(std::move(line));
  }
  if (input.finished_runs && !input.finished_runs->fitted.empty()) {
    content.warnings.push_back(
        fmt::format("runs are on packings that were fitted, too (seeds {}): they agree better than new ones would",
                    fmt::join(input.finished_runs->fitted, ", ")));
  }
}

/// Which bands there are: a path does not speak for itself, so one that alone was rehearsed has none of the law's own error.
std::string bands_along(const Law& law) {
  if (law_decides(law.path)) return "none: the law decides the strain";
  CalibratedLaw known = law.calibrated;
  if (spokesmen_for(law.segments, known.rehearsals).rehearsals.empty()) known.rehearsals.clear();
  return available_bands(known);
}

std::vector<dem::PlannedTest> planned_runs(const NewRuns& runs, const PredictionInput& input) {
  return plan(runs.spec, input.path, dem::new_seeds(runs.spec, input.path, runs.seeds, runs.fitted, input.path_name),
              input.path_name);
}

Dataset make_runs(const NewRuns& runs, const PredictionInput& input, const fs::path& output,
                  const Execution& execution) {
  const std::vector<dem::PlannedTest> planned = planned_runs(runs, input);
  dem::require_engines(planned, runs.store, execution);
  return without_empty_folders({output / "dem", output}, [&] {
    make_output_folder(output);
    const fs::path folder = make_subfolder(output, "dem");
    make_output_folder(runs.store);
    dem::RunCounts counts;
    return dem::run_planned(planned, Json(dem::spec_to_json(runs.spec)), folder, dem::RunStore(runs.store, "runs"),
                            execution, counts);
  });
}

void log_warnings(const CalibratedLaw& law, const predict::PredictionFolder& content, Watch& watch) {
  std::set<std::string> warned;
  if (!law.converged) watch.log("warning: the calibration did not converge");
  for (const std::string& warning : content.warnings) watch.log("warning: " + warning);
  for (const predict::PredictedCurve& curve : content.curves) {
    for (const std::string& warning : curve.prediction.warnings) {
      if (warned.insert(warning).second) watch.log("warning: " + warning);
    }
  }
  for (const predict::FailedCurve& failed : content.failures) {
    const std::string warning = fmt::format("{} is left out: {}", to_string(failed.model), failed.error);
    if (warned.insert(warning).second) watch.log("warning: " + warning);
  }
}

}  // namespace

std::vector<std::string> warnings_along(const CalibratedLaw& law, const PathFile& file) {
  const Path& path = file.path;
  std::vector<std::string> warnings;
  if (!knows_fabric(law.parameters))
    warnings.emplace_back("the law was calibrated without fabric: it says nothing of it");
  warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
  if (path.branch != Branch::unloading) {
    warnings.push_back(fmt::format(
        "initial.branch \"{}\": the law knows the unloading branch alone; its start, and what a packing keeps of its "
        "preparation, are those of that branch",
        to_string(path.branch)));
  }
  const auto spins = [](const PathSegment& segment) { return !segment.spin.isZero(0); };
  if (std::ranges::any_of(path.segments, spins)) {
    warnings.emplace_back(
        "the path spins, which nothing that was calibrated or rehearsed does; how far the law is off there is not "
        "known");
  }
  if (law_decides(path) || law.rehearsals.empty()) return warnings;
  const std::vector<StraightSegment> segments = resolve(path);
  const auto outside = ways_outside(traits_of(segments), spokesmen_for(segments, law.rehearsals));
  if (!outside.empty())
    warnings.push_back(
        fmt::format("outside rehearsals: {}; how far the law is off there is not known", fmt::join(outside, ", ")));
  return warnings;
}

PredictionInput read_prediction_input(const fs::path& parameters, const fs::path& path) {
  return prediction_input(parameters, read_path(path), path.string());
}

PredictionInput prediction_input(const fs::path& parameters, PathFile path, const std::string& path_name) {
  PredictionInput input{
      .law = read_parameters(parameters).law, .law_file = parameters, .path = std::move(path), .path_name = path_name};
  input.parameters = {{"file", parameters.string()},
                      {"sha256", sha256_of_file(parameters)},
                      {"law_sha256", law_digest(input.law)},
                      {"dataset_digest", input.law.dataset_digest}};
  return input;
}

dem::Spec spec_of_calibration(const fs::path& spec, const fs::path& parameters) {
  const fs::path file = spec.empty() ? parameters.parent_path() / "spec.resolved.json" : spec;
  if (spec.empty() && !fs::exists(file)) {
    throw InvalidInput(fmt::format(
        "{}: not found; --dem prepares packings by the calibration's spec, give it with --spec", file.string()));
  }
  return dem::read_spec(file);
}

NewRuns new_runs(const PredictionInput& input, dem::Spec spec, std::vector<std::uint64_t> seeds,
                 const fs::path& store) {
  const fs::path beside = input.law_file.has_parent_path() ? input.law_file.parent_path() : fs::path(".");
  NewRuns runs{std::move(spec), std::move(seeds), store.empty() ? beside : store};
  const PackingInfo packing = dem::packing_of(runs.spec);
  const auto fitted = fitted_dataset(input.law_file, input.law.dataset_digest);
  if (!fitted) return runs;
  for (const TestRecord& test : tests_of(*fitted, Role::calibration)) {
    const std::string differs = other_material(packing, test.packing);
    if (!differs.empty()) {
      throw InvalidInput(fmt::format(
          "SPEC of new runs: {} in test {}, which is fitted; a law is of one material, calibrate one for the other",
          differs, test.name));
    }
    if (test.packing.particles == packing.particles) runs.fitted.push_back(test.packing.seed);
  }
  return runs;
}

FinishedRuns finished_runs(const PredictionInput& input, const fs::path& folder) {
  const fs::path from = dataset_folder(folder);
  FinishedRuns runs{read_dataset(from), from};
  require_runs_of(input.path.path, runs.dataset, from.string());
  const auto fitted = fitted_dataset(input.law_file, input.law.dataset_digest);
  if (!fitted) return runs;
  require_judges(runs.dataset, *fitted, from.string());
  std::set<std::uint64_t> seeds;
  for (const DatasetTest& test : runs.dataset.tests) {
    if (is_fitted(test.record.packing, *fitted)) seeds.insert(test.record.packing.seed);
  }
  runs.fitted.assign(seeds.begin(), seeds.end());
  return runs;
}

void check_prediction(const PredictionInput& input) {
  if (input.initial == Initial::measured && !input.new_runs && !input.finished_runs)
    throw InvalidInput("predict: --initial measured starts from the values of a packing; give --dem or --against too");
  for (const Rung model : rungs_of(input)) require_parameters(input.law, model, input.law_file.string());
  check_starts(input);
  if (input.new_runs) planned_runs(*input.new_runs, input);  // what cannot be run
}

predict::PredictionFolder predict_path(const PredictionInput& input, const fs::path& output,
                                       const Execution& execution) {
  check_prediction(input);
  const Path& path = input.path.path;
  const bool decides = law_decides(path);
  const Law law{
      input.law, rungs_of(input), path, decides ? std::vector<StraightSegment>{} : resolve(path), {{}, execution.stop}};
  predict::PredictionFolder content;
  content.name = (output.has_filename() ? output : output.parent_path()).filename().string();
  content.path = path;
  content.parameters = input.parameters;
  content.bands = bands_along(law);
  // all that can fail comes before the first file
  if (input.initial != Initial::measured) add_free_curves(law, content);
  require_a_curve(content);
  if (input.finished_runs) content.dem = input.finished_runs->dataset;
  if (input.new_runs) content.dem = make_runs(*input.new_runs, input, output, execution);
  if (content.dem) add_compared_curves(law, input, content);
  if (!input.new_runs) require_a_curve(content);  // runs that were made stay, with what became of the law
  add_advice(law, content);
  add_rehearsals(law, content);
  add_warnings(input, content);
  make_output_folder(output);
  if (input.finished_runs)
    content.dem = adopt(input.finished_runs->dataset, input.finished_runs->folder, make_subfolder(output, "dem"));
  content.provenance = Json(provenance(execution));
  predict::write_prediction(output, content);
  log_warnings(input.law, content, execution.watch);
  require_a_curve(content);
  return content;
}

}  // namespace grainlaw::chain
