#pragma once
// Which rung of the law a path needs, and what a richer one changes on it.

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

/// memory where shear turns back, or where at constant volume the sheared pressure differs from that of ISO unloading by
/// more than 2 %; evolution where the volume changes with or after shear; else reduced.
RungAdvice rung_needed(const LawParameters<double>& parameters, const std::vector<StraightSegment>& segments);

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
