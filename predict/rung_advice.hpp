#pragma once
// Which rung of the law a path needs by what it contains, which did best on rehearsals, and what a richer one changes.

#include "predict/predict.hpp"

namespace grainlaw::predict {

struct RungAdvice {
  Rung rung = Rung::reduced;  ///< the cheapest that contains what the path does
  std::string why;            ///< e.g. "segments[1] turns the shear back"
};
constexpr auto fields_of(std::type_identity<RungAdvice>) {
  return std::tuple{Field{&RungAdvice::rung, "needed"}, Field{&RungAdvice::why, "why"}};
}
static_assert(tells_every_member<RungAdvice>());

/// memory where shear turns back, or spin turns the state against it, or where at constant volume the sheared pressure
/// differs from that of ISO unloading by more than 2 %; evolution where the volume changes with or after shear; else
/// reduced.
RungAdvice rung_needed(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments);

/// The rung whose curve is shown first.
struct RungRecommendation {
  Rung rung = Rung::reduced;
  bool rehearsed = false;  ///< by rehearsals; else by what the path contains
  std::string why;         ///< by how much, or that there are no rehearsals
};
constexpr auto fields_of(std::type_identity<RungRecommendation>) {
  using R = RungRecommendation;
  return std::tuple{Field{&R::rung, "recommended"}, Field{&R::rehearsed, "rehearsed"},
                    Field{&R::why, "recommended_why"}};
}
static_assert(tells_every_member<RungRecommendation>());

/// The best of `rungs` (not empty) on the rehearsals that speak for the path (scores() of model/rehearsals.hpp); without
/// any the one that is `needed`, or where that is none of them the richest.
RungRecommendation recommended_rung(const std::vector<Rehearsal>& rehearsals,
                                    const std::vector<StraightSegment>& segments, const std::vector<Rung>& rungs,
                                    const RungAdvice& needed);

/// Largest differences over the rows that both have, jammed in both.
struct RungDifference {
  double P = 0;  ///< of P*, relative to the first's [-]
  double s = 0;  ///< |sigma'/P - sigma'/P| [-]
  double F = 0;  ///< |F' - F'| [-]
};
constexpr auto fields_of(std::type_identity<RungDifference>) {
  using D = RungDifference;
  return std::tuple{Field{&D::P, "P_star"}, Field{&D::s, "stress_ratio"}, Field{&D::F, "fabric"}};
}
static_assert(tells_every_member<RungDifference>());

/// Of two predictions at the same points.
RungDifference difference(const Prediction& cheaper, const Prediction& richer);

}  // namespace grainlaw::predict
