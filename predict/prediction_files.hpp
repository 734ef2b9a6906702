#pragma once
// The folder of a prediction: prediction.json, one CSV for each curve, and with --dem the new runs as a data set in
// dem/ and comparison.json.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/files/dataset.hpp"
#include "predict/compare.hpp"
#include "predict/predict.hpp"
#include "predict/rung_advice.hpp"

namespace grainlaw::predict {

enum class Initial { law, measured };  ///< start of a prediction: the calibrated law, or the packing's measured values
constexpr auto names_of(Initial) { return std::array{"law", "measured"}; }

/// The law along the path.
struct PredictedCurve {
  Rung model = Rung::evolution;
  Initial initial = Initial::law;
  std::optional<std::uint64_t> seed;  ///< of the DEM run at whose rows the curve was computed; none: equal steps
  std::string file;                   ///< CSV in the prediction's folder
  Prediction prediction;
};
/// The keys that come first; the prediction follows.
GRAINLAW_SOME_FIELDS(PredictedCurve, model, initial, seed, file);

/// One curve against one DEM run, or the mean over runs.
struct CurveComparison {
  Rung model = Rung::evolution;
  Initial initial = Initial::law;
  std::optional<std::uint64_t> seed;  ///< none: mean over seeds (largest: of the seed where it is largest)
  Comparison comparison;              ///< test "mean" when none
};
constexpr auto fields_of(std::type_identity<CurveComparison>) {
  using C = CurveComparison;
  return std::tuple{Field{&C::model, "model"}, Field{&C::initial, "initial"}, Field{&C::seed, "seed"},
                    Field{&C::comparison, ""}};
}
static_assert(tells_every_member<CurveComparison>());

/// What a richer rung changes on the curves from the law's start.
struct RungChange {
  Rung cheaper = Rung::reduced, richer = Rung::evolution;
  RungDifference difference;
};
constexpr auto fields_of(std::type_identity<RungChange>) {
  using C = RungChange;
  return std::tuple{Field{&C::cheaper, "from"}, Field{&C::richer, "to"}, Field{&C::difference, ""}};
}
static_assert(tells_every_member<RungChange>());

/// A curve that there is not: the law did not converge on it.
struct FailedCurve {
  Rung model = Rung::evolution;
  Initial initial = Initial::law;
  std::optional<std::uint64_t> seed;  ///< of the DEM run at whose rows it was wanted; none: equal steps
  std::string error;                  ///< one line
};
GRAINLAW_FIELDS(FailedCurve, model, initial, seed, error);

/// What rehearsals say of one rung on a path.
struct RehearsedError {
  LawError error;
  double whole_curve =
      std::numeric_limits<double>::quiet_NaN();  ///< `largest` at the path's widest w: half width of a band
                                                 ///< that holds the whole mean curve [-]
};
constexpr auto fields_of(std::type_identity<RehearsedError>) {
  return std::tuple{Field{&RehearsedError::error, ""}, Field{&RehearsedError::whole_curve, "whole_curve"}};
}
static_assert(tells_every_member<RehearsedError>());

struct RehearsedModel {
  Rung model = Rung::evolution;
  RehearsedError P_star, s_par, F_par;
};
GRAINLAW_FIELDS(RehearsedModel, model, P_star, s_par, F_par);

/// Whose rehearsals speak for a path, and what they say.
struct PathRehearsals {
  PathKind kind = PathKind::monotone;  ///< of the path
  int paths = 0;                       ///< m
  bool of_kind = false;                ///< whether they are of its kind; else all there are
  std::vector<std::string> outside;    ///< in which ways the path goes beyond them
  double whole_curve_probability = 0;  ///< m/(m + 1)
  std::vector<RehearsedModel> models;  ///< of the rungs that have curves
};
GRAINLAW_FIELDS(PathRehearsals, kind, paths, of_kind, outside, whole_curve_probability, models);

struct PredictionFolder {
  std::string name;  ///< last part of the folder's path
  Path path;
  RungAdvice needed;                ///< rung that the path needs by what it contains
  RungRecommendation recommended;   ///< rung whose curve is shown first
  std::vector<RungChange> changes;  ///< none where the law decides the strain: no two rows are at the same strain
  std::string bands;                ///< one line: which there are, or why there are none
  std::optional<PathRehearsals> rehearsals;  ///< none: no path was rehearsed, or the law decides the strain
  std::vector<std::string> warnings;         ///< of the path, whatever the curve
  std::vector<PredictedCurve> curves;
  std::vector<FailedCurve> failures;
  std::optional<Dataset> dem;  ///< the runs in dem/
  std::vector<CurveComparison> comparisons;
  Json parameters;  ///< file, sha256, law_sha256, dataset_digest of the parameters used
  Json provenance;
};

/// Writes curves, prediction.json and, when there are DEM runs, comparison.json; dem/ must already be written.
void write_prediction(const std::filesystem::path& folder, const PredictionFolder& content);

/// `rung` of prediction.json and of `predict --json`.
OrderedJson rung_to_json(const PredictionFolder& content);

/// Throws InvalidInput naming file and key.
PredictionFolder read_prediction(const std::filesystem::path& folder);

/// The series of a prediction as CSV, doubles bit for bit. Columns may come in any order; the columns of the bands may be missing or empty.
void write_prediction_series(const std::filesystem::path& file, const std::vector<PredictedRow>& rows);
std::vector<PredictedRow> read_prediction_series(const std::filesystem::path& file);

/// Mean of each quantity over the seeds of a model and initial.
std::vector<CurveComparison> mean_over_seeds(const std::vector<CurveComparison>& comparisons);

}  // namespace grainlaw::predict
