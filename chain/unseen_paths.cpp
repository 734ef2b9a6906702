#include "chain/unseen_paths.hpp"

#include <algorithm>
#include <cmath>

#include "chain/fitted_paths.hpp"

namespace grainlaw::chain {
namespace {

constexpr std::array<const char*, 3> kQuantities = names_of(Rehearsed{});

std::vector<PathError> errors_of(const predict::PredictionFolder& prediction) {
  std::vector<PathError> errors;
  if (!prediction.dem) return errors;
  using predict::Initial;
  const bool by_law = std::ranges::any_of(prediction.comparisons, [](const predict::CurveComparison& comparison) {
    return comparison.initial == Initial::law;
  });
  for (const predict::CurveComparison& mean : prediction.comparisons) {
    if (mean.seed || mean.initial != (by_law ? Initial::law : Initial::measured)) continue;
    PathError& error = errors.emplace_back();
    error.path = prediction.name + (by_law ? "" : " (measured start)");
    error.along = &prediction.path;
    if (!law_decides(prediction.path)) error.kind = kind_of(traits_of(resolve(prediction.path)));
    error.prediction = &prediction;
    error.rung = mean.model;
    error.recommended = mean.model == prediction.recommended.rung;
    for (const predict::QuantityComparison& q : mean.comparison.quantities) {
      const auto at = std::ranges::find(kQuantities, q.quantity) - kQuantities.begin();
      if (at == std::ssize(kQuantities)) continue;
      const auto i = static_cast<std::size_t>(at);
      error.error[i] = q.normalised_rms;
      error.in_band[i] = q.coverage_single;
    }
  }
  return errors;
}

/// Units of w over the largest value that the law has on the path: that of P* where it is densest, the steady values of s and F
/// are their own units.
double relative_unit(const CalibratedLaw& law, const PathTraits& traits, Rehearsed quantity) {
  if (quantity != Rehearsed::P_star) return 1;
  const double P = law.parameters.isotropic.P_star(traits.nu_max);
  return P > 0 ? error_units(law.parameters, traits.nu_max).B / P : PathError::kNone;
}

std::vector<PathError> errors_of(const Rehearsal& rehearsal, const CalibratedLaw& law) {
  std::vector<PathError> errors;
  const std::optional<Rung> recommended = recommended_along(law, rehearsal.path);
  for (const RehearsedRung& followed : rehearsal.rungs) {
    PathError& error = errors.emplace_back();
    error.path = rehearsal.name;
    error.along = &rehearsal.path;
    error.kind = rehearsal.kind;
    error.rung = followed.rung;
    error.recommended = followed.rung == recommended;
    for (const Rehearsed quantity : kValues<Rehearsed>) {
      const RehearsedQuantity& q = followed.of(quantity);
      if (q.rows > 0)
        error.error[static_cast<std::size_t>(quantity)] =
            std::sqrt(q.square) * relative_unit(law, rehearsal.traits, quantity);
    }
  }
  return errors;
}

}  // namespace

std::vector<PathError> errors_on_unseen_paths(const ReportInput& input) {
  std::vector<PathError> all;
  std::vector<const Path*> predicted;
  for (const predict::PredictionFolder& prediction : input.predictions) {
    if (input.strange.contains(prediction.name)) continue;
    const std::vector<PathError> errors = errors_of(prediction);
    all.insert(all.end(), errors.begin(), errors.end());
    if (!errors.empty()) predicted.push_back(&prediction.path);
  }
  for (const Rehearsal& rehearsal : input.calibration.law.rehearsals) {
    if (std::ranges::any_of(predicted, [&](const Path* path) { return same_path(*path, rehearsal.path); })) continue;
    const std::vector<PathError> errors = errors_of(rehearsal, input.calibration.law);
    all.insert(all.end(), errors.begin(), errors.end());
  }
  std::erase_if(all, [](const PathError& entry) {
    return std::ranges::none_of(entry.error, [](double error) { return error >= 0; });
  });
  return all;
}

}  // namespace grainlaw::chain
