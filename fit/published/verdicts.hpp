#pragma once
// Ours against the published numbers, one verdict each: of every parameter in Tables 2 and 3 of the paper and of the curves
// that they stand for, mode by mode. The difference is measured in standard errors of a difference between our mean over n
// packings and one other packing, which is what the paper shows: SE sqrt(n + 1), under the assumption that the paper's
// packing scatters like ours. Within the 95 % range of Student's t it "agrees" if that range is narrower than the difference
// that matters, else it is "inconclusive": a wide range would agree with anything. Spheres of another material than the
// paper's are not judged by its numbers.

#include <optional>
#include <string>
#include <vector>

#include "fit/describe.hpp"
#include "fit/published/paper_claims.hpp"

namespace grainlaw::fit {

struct Verdict {
  std::string mode;           ///< "ISO", "UNI", "D2", "D3", "D2-loading"
  std::string quantity;       ///< name of the parameter or curve, e.g. "coordination.C1", "P_star"
  std::optional<double> nu;   ///< of a value of a curve; none: a parameter of a table [-]
  double ours = 0;            ///< NaN when not identified [-]
  double standard_error = 0;  ///< NaN where there is none [-]
  double published = 0;       ///< [-]
  double distance = 0;        ///< difference over SE sqrt(n + 1); NaN without an error
  double range = 0;           ///< half of the 95 % range of the difference; NaN without an error [-]
  double matters = 0;         ///< the difference that matters, difference_that_matters() [-]
  std::string verdict{};      ///< "agrees", "inconclusive", "differs", "no error", "not identified", "another material"
};
GRAINLAW_FIELDS(Verdict, mode, quantity, nu, ours, standard_error, published, distance, range, matters, verdict);

/// The modes besides the calibration's own, and how all of them compare with what was published.
struct ModeComparison {
  std::vector<Description> descriptions;
  std::vector<Verdict> verdicts;
  std::vector<Claim> claims;
};

/// By how much `quantity` (a curve at `nu`, or without it a parameter) may be off the value `published` before it matters: of
/// a curve what one packing of 4000 spheres scatters by (C* 1 %, 2 % below .70; phi_r 25 %, from .78 on .0015; P* 2 %, 5 %
/// below .70; s_max 5, beta_s 20, F_max 7, beta_F 30 %); of a jamming density .0025, D .02, g3 .045, gamma_p .1, of Q_limit
/// and Q_c their curve's at .74, of other parameters 10 %. Always above zero.
double difference_that_matters(const std::string& quantity, std::optional<double> nu, double published);

/// Curves at .68 (where the rows reach it), .70, .74, .80 and .82; `packings` n of `law`; descriptions have their own. What no data
/// tell, as C* where no row counts contacts, is left out: published numbers that stand in for it would agree with themselves.
std::vector<Verdict> verdicts_of(const CalibratedLaw& law, const std::vector<Description>& descriptions, int packings);

/// The verdict on a number of the paper that is of another material than ours.
inline constexpr const char* kAnotherMaterial = "another material";
/// What sets the spheres of `tests`, all of one material, apart from the paper's (w = 3, Eq. (1)), as other_material() says
/// it; empty: nothing known to.
std::string other_than_the_papers(const std::vector<TestRecord>& tests);
/// Where they are of another material, every verdict on a published number becomes kAnotherMaterial. Signs, equalities and
/// identities among the claims stay: they compare ours with ours.
void set_aside_other_material(ModeComparison& modes, const std::vector<TestRecord>& tests);

}  // namespace grainlaw::fit
