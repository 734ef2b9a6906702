#pragma once
// How far the law is off on paths that no fit saw: rehearsals. Replicate packings share one law, so no number of them shows
// its error; paths are the unit. Each path is one record, and from the records of paths of one kind follows what the law's
// own error adds to the bands of another path, and which rung does best. Formulas: docs/theory/bands.md, Rehearsals.

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "model/law.hpp"
#include "model/vocabulary/fields.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw {

/// Paths on which the law errs alike. Derived from the path, never said by the user.
enum class PathKind {
  monotone,   ///< the shear keeps its direction and the volume never grows
  unloading,  ///< the volume grows on a segment, and the shear turns back once at most
  turning,    ///< the shear changes its direction, and turns back once at most
  cyclic,     ///< the shear turns back twice or more
};
constexpr auto names_of(PathKind) { return std::array{"monotone", "unloading", "turning", "cyclic"}; }

/// What of a path decides whether another one speaks for it.
struct PathTraits {
  double nu_min = 0, nu_max = 0;  ///< of all its places [-]
  double eps_dev = 0;             ///< largest deviatoric strain since the start, at corners [-]
  double shear_path = 0;          ///< length of the shear, all segments [-]
  double lode_min = 0,
         lode_max = 0;   ///< l of law_state.hpp over its shears: 0 in D2, 1 in D3 and UNI; 0 without shear [-]
  int turns = 0;         ///< corners at which the shear changes its direction
  int reversals = 0;     ///< of these, where it turns back: <N, N before> < 0
  bool expands = false;  ///< whether the volume grows on a segment
};
GRAINLAW_FIELDS(PathTraits, nu_min, nu_max, eps_dev, shear_path, lode_min, lode_max, turns, reversals, expands);

PathTraits traits_of(const std::vector<StraightSegment>& path);
/// Of two paths together.
PathTraits both(const PathTraits& a, const PathTraits& b);
PathKind kind_of(const PathTraits& traits);

/// What rehearsals are about: the quantities whose bands they widen.
enum class Rehearsed { P_star, s_par, F_par };
constexpr auto names_of(Rehearsed) { return std::array{"P_star", "s_par", "F_par"}; }

/// The unit w in which the error of each quantity counts at a volume fraction: B*, s_max, F_max. Errors of P* in units of B*
/// are errors of volumetric strain.
struct ErrorUnits {
  double B = 0, s_max = 0, F_max = 0;
  double of(Rehearsed quantity) const;
};
ErrorUnits error_units(const LawParameters<double>& parameters, double nu);

/// One quantity by one rung on one path, d the mean of the runs minus the law: means over rows.
struct RehearsedQuantity {
  int rows = 0;        ///< that count: as in a comparison, shear_path >= .01
  double square = 0;   ///< of d^2/w^2 [-]
  double known = 0;    ///< of what was expected of that: (g.V g + sigma^2/n)/w^2 [-]
  double largest = 0;  ///< largest |d|/w [-]
};
GRAINLAW_FIELDS(RehearsedQuantity, rows, square, known, largest);

struct RehearsedRung {
  Rung rung = Rung::evolution;
  RehearsedQuantity P_star, s_par, F_par;

  const RehearsedQuantity& of(Rehearsed quantity) const;
};
constexpr auto fields_of(std::type_identity<RehearsedRung>) {
  using R = RehearsedRung;
  return std::tuple{Field{&R::rung, "model"}, Field{&R::P_star, "P_star"}, Field{&R::s_par, "s_par"},
                    Field{&R::F_par, "F_par"}};
}
static_assert(tells_every_member<RehearsedRung>());

/// One path that no fit saw, with runs of it.
struct Rehearsal {
  std::string name;
  PathKind kind = PathKind::monotone;
  PathTraits traits;
  int packings = 0;                  ///< runs
  std::vector<RehearsedRung> rungs;  ///< that followed it to its end
  Path path;
};
/// All but the path, which stands beside them in files.
GRAINLAW_SOME_FIELDS(Rehearsal, name, kind, traits, packings, rungs);

/// Those that speak for a path: of its kind where there are enough, else all; never the path itself.
struct Spokesmen {
  PathKind kind = PathKind::monotone;  ///< of the path
  bool of_kind = false;                ///< whether all are of that kind
  std::vector<const Rehearsal*> rehearsals;
};
inline constexpr std::size_t kEnoughOfAKind = 4;
Spokesmen spokesmen_for(const std::vector<StraightSegment>& path, const std::vector<Rehearsal>& rehearsals);

/// In which ways `path` goes beyond those that speak for it, e.g. "nu down to 0.66 (rehearsed: 0.68)"; none without any.
std::vector<std::string> ways_outside(const PathTraits& path, const Spokesmen& spokesmen);

/// The law's own error in one quantity, in units of w.
struct LawError {
  double tau = std::numeric_limits<double>::quiet_NaN();      ///< standard deviation [-]; NaN without rehearsals
  double degrees_of_freedom = 0;                              ///< m
  double rms = std::numeric_limits<double>::quiet_NaN();      ///< D, what tau is part of [-]
  double largest = std::numeric_limits<double>::quiet_NaN();  ///< of all rows of all paths [-]
};
GRAINLAW_FIELDS(LawError, tau, degrees_of_freedom, rms, largest);

/// tau^2 = max(0, mean_j square_j - mean_j known_j) over the spokesmen that `rung` followed.
LawError law_error(const Spokesmen& spokesmen, Rung rung, Rehearsed quantity);

/// How the rungs do on the same rehearsals: of each the root mean square over the quantities of D over the least D of all
/// rungs, so 1 is best in everything. Units of w would not do: those of P* are strains, a hundred times smaller.
struct RungScore {
  Rung rung = Rung::reduced;
  double score = 0;
  std::array<double, 3> rms{};  ///< D of each quantity, in the order of Rehearsed [-]
};
/// Best first; of the spokesmen that all of `rungs` followed; empty without any.
std::vector<RungScore> scores(const Spokesmen& spokesmen, const std::vector<Rung>& rungs);

}  // namespace grainlaw
