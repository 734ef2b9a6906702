#pragma once
// Paths on which the law decides where they lead: rates left free for stresses, P or the stress ratio to keep to theirs,
// and segments that end at a value of the law. The rate of strain is D + sum_k a_k M_k, D the segment's direction, M_k the
// free directions, and a_k solve
//   d c_k(state; D + sum a M)/de = r_k - kappa (c_k - c_k(0) - r_k e)        c_k: stress, P or |sigma'|/P, r_k its rate
// by Newton's method from the tangent of the right-hand side (the rate is homogeneous in the strain rate, not linear: it
// holds its norm). The last term takes back what drifts. Unknowns: state, strain, shear path, by CVODE.
// s_r (model/memory.hpp) turns at the corners of the path alone: on a segment it rests.

#include "predict/predict.hpp"

namespace grainlaw::predict {

/// As predict(), for any path; `per_segment` equal intervals of the path parameter on each segment. The rows end where the
/// state unjams. Throws NotConverged naming the segment where no free rate keeps to the conditions (a stress beyond what
/// the state can carry), or where an extent is not reached within a strain of `kMostStrain`; InvalidInput for
/// Rung::reduced, whose closed form has no tangent.
Prediction predict_by_law(Rung rung, const LawParameters<double>& parameters, Coupling coupling, const Path& path,
                          const LawState<double>& start, int per_segment, const Tolerances& tolerances,
                          const ValidRange& range, const RunControl& control);

inline constexpr double kMostStrain = 2;  ///< norm of the strain by which a segment must have reached its end [-]

}  // namespace grainlaw::predict
