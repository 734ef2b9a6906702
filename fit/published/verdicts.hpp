#pragma once
// Ours against the published numbers, one verdict each: of every parameter in Tables 2 and 3 of the paper and of the curves
// that they stand for, mode by mode. The difference is measured in standard errors of a difference between our mean over n
// packings and one other packing, which is what the paper shows: SE sqrt(n + 1), under the assumption that the paper's
// packing scatters like ours. "agrees" within the 95 % range of Student's t with n - 1 degrees of freedom.

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
  std::string verdict;        ///< "agrees", "differs", "no error", "not identified"
};
constexpr auto fields_of(std::type_identity<Verdict>) {
  using V = Verdict;
  return std::tuple{Field{&V::mode, "mode"},
                    Field{&V::quantity, "quantity"},
                    Field{&V::nu, "nu"},
                    Field{&V::ours, "ours"},
                    Field{&V::standard_error, "standard_error"},
                    Field{&V::published, "published"},
                    Field{&V::distance, "distance"},
                    Field{&V::verdict, "verdict"}};
}
static_assert(tells_every_member<Verdict>());

/// The modes besides the calibration's own, and how all of them compare with what was published.
struct ModeComparison {
  std::vector<Description> descriptions;
  std::vector<Verdict> verdicts;
  std::vector<Claim> claims;
};

/// Curves at .68 (where the rows reach it), .70, .74, .80 and .82; `packings` n is the number of seeds.
std::vector<Verdict> verdicts_of(const CalibratedLaw& law, const std::vector<Description>& descriptions,
                                 std::size_t packings);

}  // namespace grainlaw::fit
