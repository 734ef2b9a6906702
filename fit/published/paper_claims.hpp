#pragma once
// What the paper says beyond the numbers of Tables 2 and 3: kinematics of Table 1, orders of modes, and which states are
// the same. Each claim is one number of ours with its standard error over the packings (differences are taken packing by
// packing, on rows of the same densities) and the value or the sign that the paper gives.

#include <limits>
#include <string>
#include <vector>

#include "fit/describe.hpp"

namespace grainlaw::fit {

struct Claim {
  std::string where;          ///< in the paper, e.g. "Table 1", "Fig. 5"
  std::string statement;      ///< what `ours` is and what is said of it
  double nu = 0;              ///< volume fraction; NaN: of none in particular [-]
  double ours = 0;            ///< [-, Lode angles deg]
  double standard_error = 0;  ///< NaN where there is none
  double published = 0;       ///< NaN: only the sign is said, ours should be above zero
  std::string verdict;  ///< "agrees", "inconclusive", "differs", "undecided" (a sign within its error), "no error",
                        ///< "identity" (exact kinematics, which no measurement could deny), "another material"
  double matters =
      std::numeric_limits<double>::quiet_NaN();  ///< difference that matters; NaN: of a sign or an identity
};
GRAINLAW_FIELDS(Claim, where, statement, nu, ours, standard_error, published, matters, verdict);

/// Half of the last digit that the paper prints, 0 for what is exact; the difference that matters.
struct Printed {
  double value = std::numeric_limits<double>::quiet_NaN();
  double half_digit = 0;
  double matters = 0;
};

/// Fills in the verdict. A printed value is that of one other packing: SE sqrt(n + 1) times Student's t, and half a digit;
/// within this range it agrees if the range is narrower than the difference that matters, else it is inconclusive. An exact
/// one (no scatter, SE at rounding) must be met to 1e-6 and is then an identity, no evidence. A sign must differ from zero by
/// its 95 % range.
void judge(Claim& claim, Printed printed, std::size_t packings);
/// Likewise of two sides that are said to be equal: agrees when zero lies within the 95 % range of `ours` and that is
/// narrower than `matters`.
void judge_equal(Claim& claim, double matters, std::size_t packings);

/// All that `tests` (calibration and description) and the fits can speak of, in the order of the paper.
std::vector<Claim> claims_of(const std::vector<TestRecord>& tests, const Calibration& calibration,
                             const std::vector<Description>& descriptions, double steady_from);

}  // namespace grainlaw::fit
