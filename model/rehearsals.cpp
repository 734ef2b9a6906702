#include "model/rehearsals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace grainlaw {
namespace {

constexpr double kNoTurn = 1e-6;  // 1 - <N, N before> by rounding
constexpr double kSlack = 1e-3;   // of densities and strains that are as good as rehearsed

const RehearsedRung* rung_of(const Rehearsal& rehearsal, Rung rung) {
  const auto found = std::ranges::find(rehearsal.rungs, rung, &RehearsedRung::rung);
  return found == rehearsal.rungs.end() ? nullptr : &*found;
}

}  // namespace

PathTraits traits_of(const std::vector<StraightSegment>& path) {
  PathTraits traits;
  if (path.empty()) return traits;
  traits.nu_min = traits.nu_max = path.front().nu_start;
  Deviator<double> N = Deviator<double>::Zero();
  for (const StraightSegment& segment : path) {
    const double nu = segment.nu(segment.length);
    traits.nu_min = std::min(traits.nu_min, nu);
    traits.nu_max = std::max(traits.nu_max, nu);
    traits.eps_dev = std::max(traits.eps_dev, deviatoric_norm(segment.strain(segment.length).tensor));
    traits.shear_path += segment.eps_dev_rate() * segment.length;
    const LawDirection direction = path_direction(segment.direction.tensor);
    traits.expands = traits.expands || direction.dx < -kPathNoise * direction.de;
    if (!(direction.de > 0)) continue;
    if (N.isZero()) {
      traits.lode_min = traits.lode_max = direction.lode;
    } else if (const double cosine = direction.N.dot(N); cosine < 1 - kNoTurn) {
      ++traits.turns;
      if (cosine < -kNoTurn) ++traits.reversals;
    }
    traits.lode_min = std::min(traits.lode_min, direction.lode);
    traits.lode_max = std::max(traits.lode_max, direction.lode);
    N = direction.N;
  }
  return traits;
}

PathKind kind_of(const PathTraits& traits) {
  if (traits.reversals > 1) return PathKind::cyclic;
  if (traits.expands) return PathKind::unloading;
  return traits.turns > 0 ? PathKind::turning : PathKind::monotone;
}

double ErrorUnits::of(Rehearsed quantity) const {
  return quantity == Rehearsed::P_star ? B : quantity == Rehearsed::s_par ? s_max : F_max;
}

ErrorUnits error_units(const LawParameters<double>& parameters, double nu) {
  const double at = reference_density(parameters, nu);
  return {parameters.isotropic.B_star(at), parameters.stress_ratio_max.value(at, parameters.shear_nu_c),
          parameters.fabric_max.value(at, parameters.shear_nu_c)};
}

const RehearsedQuantity& RehearsedRung::of(Rehearsed quantity) const {
  return quantity == Rehearsed::P_star ? P_star : quantity == Rehearsed::s_par ? s_par : F_par;
}

Spokesmen spokesmen_for(const std::vector<StraightSegment>& path, const std::vector<Rehearsal>& rehearsals) {
  Spokesmen all{kind_of(traits_of(path)), false, {}}, alike{all.kind, true, {}};
  for (const Rehearsal& rehearsal : rehearsals) {
    if (same_but_axes(resolve(rehearsal.path), path)) continue;
    all.rehearsals.push_back(&rehearsal);
    if (rehearsal.kind == all.kind) alike.rehearsals.push_back(&rehearsal);
  }
  return alike.rehearsals.size() < kEnoughOfAKind ? all : alike;
}

PathTraits both(const PathTraits& a, const PathTraits& b) {
  return {std::min(a.nu_min, b.nu_min),         std::max(a.nu_max, b.nu_max),       std::max(a.eps_dev, b.eps_dev),
          std::max(a.shear_path, b.shear_path), std::min(a.lode_min, b.lode_min),   std::max(a.lode_max, b.lode_max),
          std::max(a.turns, b.turns),           std::max(a.reversals, b.reversals), a.expands || b.expands};
}

std::vector<std::string> ways_outside(const PathTraits& path, const Spokesmen& spokesmen) {
  std::vector<std::string> ways;
  if (spokesmen.rehearsals.empty()) return ways;
  PathTraits seen = spokesmen.rehearsals.front()->traits;
  for (const Rehearsal* rehearsal : spokesmen.rehearsals) seen = both(seen, rehearsal->traits);
  const auto beyond = [&](const char* what, double value, double limit) {
    ways.push_back(fmt::format("{} {:.4g} (rehearsed: {:.4g})", what, value, limit));
  };
  if (path.nu_min < seen.nu_min - kSlack) beyond("nu down to", path.nu_min, seen.nu_min);
  if (path.nu_max > seen.nu_max + kSlack) beyond("nu up to", path.nu_max, seen.nu_max);
  if (path.eps_dev > seen.eps_dev + kSlack) beyond("eps_dev up to", path.eps_dev, seen.eps_dev);
  if (path.shear_path > seen.shear_path + kSlack) beyond("shear path", path.shear_path, seen.shear_path);
  if (path.lode_min < seen.lode_min - kSlack)
    beyond("-cos(3 theta) of the shear down to", path.lode_min, seen.lode_min);
  if (path.lode_max > seen.lode_max + kSlack) beyond("-cos(3 theta) of the shear up to", path.lode_max, seen.lode_max);
  if (path.turns > seen.turns) beyond("turns of the shear:", path.turns, seen.turns);
  if (path.reversals > seen.reversals) beyond("reversals:", path.reversals, seen.reversals);
  if (path.expands && !seen.expands) ways.emplace_back("the volume grows (rehearsed: never)");
  return ways;
}

LawError law_error(const Spokesmen& spokesmen, Rung rung, Rehearsed quantity) {
  double square = 0, known = 0, largest = 0;
  int m = 0;
  for (const Rehearsal* rehearsal : spokesmen.rehearsals) {
    const RehearsedRung* followed = rung_of(*rehearsal, rung);
    if (followed == nullptr || followed->of(quantity).rows == 0) continue;
    const RehearsedQuantity& q = followed->of(quantity);
    ++m;
    square += q.square;
    known += q.known;
    largest = std::max(largest, q.largest);
  }
  if (m == 0) return {};
  return {std::sqrt(std::max(0.0, square - known) / m), static_cast<double>(m), std::sqrt(square / m), largest};
}

std::vector<RungScore> scores(const Spokesmen& spokesmen, const std::vector<Rung>& rungs) {
  Spokesmen common{spokesmen.kind, spokesmen.of_kind, {}};
  for (const Rehearsal* rehearsal : spokesmen.rehearsals) {
    if (std::ranges::all_of(rungs, [&](Rung rung) { return rung_of(*rehearsal, rung) != nullptr; }))
      common.rehearsals.push_back(rehearsal);
  }
  std::vector<RungScore> table;
  if (common.rehearsals.empty()) return table;
  for (const Rung rung : rungs) {
    RungScore& score = table.emplace_back(RungScore{rung, 0, {}});
    for (const Rehearsed quantity : kValues<Rehearsed>)
      score.rms[static_cast<std::size_t>(quantity)] = law_error(common, rung, quantity).rms;
  }
  std::array<double, 3> least{};
  for (std::size_t q = 0; q < least.size(); ++q)
    least[q] = std::ranges::min(table, {}, [q](const RungScore& s) { return s.rms[q]; }).rms[q];
  for (RungScore& score : table) {
    double sum = 0;
    int counted = 0;
    for (std::size_t q = 0; q < least.size(); ++q) {
      if (!(least[q] > 0)) continue;  // no row has it, as s and F of a path without shear
      sum += std::pow(score.rms[q] / least[q], 2);
      ++counted;
    }
    score.score = counted > 0 ? std::sqrt(sum / counted) : 1;
  }
  std::ranges::stable_sort(table, {}, &RungScore::score);
  return table;
}

}  // namespace grainlaw
