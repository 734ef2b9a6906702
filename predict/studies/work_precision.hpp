#pragma once
// Work against precision: paths of three kinds by every integrator at every accuracy, each against the same path at a
// tolerance of 1e-13.

#include <string>
#include <vector>

#include "model/parameters.hpp"
#include "model/vocabulary/fields.hpp"
#include "model/vocabulary/run_control.hpp"
#include "predict/studies/walker.hpp"

namespace grainlaw::predict {

struct StudyPath {
  std::string name;         ///< smooth, reversal, near-unjamming
  std::string description;  ///< one line
  std::vector<StraightSegment> segments;
  LawState<double> start;
};

/// UNI from nu = .695 to .82; D2 to and fro at nu = .70; ISO unloading to just above jamming, then D2.
std::vector<StudyPath> study_paths(const LawParameters<double>& parameters);

struct WorkPoint {
  Integrator integrator = Integrator::adams;
  double accuracy = 0;  ///< relative tolerance, or the substep of euler [-]
  double error = 0;     ///< largest of |dP|/P, |dsigma'|/P, |dF'| at the ends of the segments, P that of the reference
  long rhs_evaluations = 0, steps = 0;
  double microseconds = 0;  ///< of one path, the least of the repeats
};
GRAINLAW_FIELDS(WorkPoint, integrator, accuracy, error, rhs_evaluations, steps, microseconds);

struct WorkPrecision {
  StudyPath path;
  LawState<double> end;               ///< of the reference, at the end of the path
  double reference_disagreement = 0;  ///< error of Adams at 1e-13 against the reference, erk_8 at 1e-13
  std::vector<WorkPoint> points;      ///< by integrator, the coarsest first
};

/// Throws Interrupted.
WorkPrecision measure_work(const StudyPath& path, const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                           int repeats, const RunControl& control);

/// The quickest point of `integrator` (of all but euler when none is given) with an error of at most `error`; null when
/// there is none.
const WorkPoint* quickest(const WorkPrecision& study, double error, const Integrator* integrator = nullptr);

}  // namespace grainlaw::predict
