#pragma once
// Eq. (16), with or without memory, by CVODE along straight segments, one initialisation for each: the jump of the
// direction at a corner is a boundary of the integration, never inside a step, and so are these events, found as roots:
//   unjammed  P falls to 1e-12 of its start (evolution: or nu to the jamming density): P = tau = F' = 0 from there on
//   tension   the least principal stress falls to zero before: without cohesion and friction nothing holds the spheres
//             together across that axis any more, and the packing comes apart as if P had vanished
//   jammed    nu rises above nu_J, the density at which the state unjammed: from P = tau = F' = 0
// and, of Rung::memory, the beginning and the end of a stretch where s_r follows s. With the slopes of the state to parameters until the state unjams
// (segment_sensitivity.hpp). Unknowns: those of SegmentLaw; independent variable: path parameter e.

#include <optional>
#include <vector>

#include "predict/path_walk.hpp"
#include "predict/solvers/cvode.hpp"

namespace grainlaw::predict {

/// P + lambda, lambda the least eigenvalue of sigma'; where |sigma'| is far below P a lower bound of it, which costs less [-].
double least_principal_stress(double P, const Deviator<double>& sigma);

/// Followed by walk().
class PathIntegration {
 public:
  /// The parameters must outlive the object.
  PathIntegration(const LawParameters<double>& parameters, Rung rung, Coupling coupling, const PathStart& start,
                  const Tolerances& tolerances);

  /// Begins the next segment, `index` in the path; it must outlive the stay in it.
  void enter(const StraightSegment& segment, int index);

  /// Moves on to path parameter `e` of the segment, not before the last one, through whatever events lie between. Throws
  /// NotConverged where the solver fails.
  void advance(double e);

  const LawState<double>& state() const { return state_; }  ///< all zero while unjammed
  std::vector<LawState<double>> slopes() const;             ///< of the state, to each parameter of the start's steps
  const std::vector<PathEvent>& events() const { return events_; }
  SolverStatistics statistics() const { return solver_.statistics(); }

 private:
  double event(double e, const double* y) const;
  void start_from(const LawState<double>& state);
  void turn();
  void move_jammed(double e);
  void move_unjammed(double e);
  void take_event();
  void note(EventKind kind);

  const LawParameters<double>& parameters_;
  Rung rung_;
  Coupling coupling_;
  double P_held_, P_floor_;
  std::vector<ParameterStep> steps_;
  std::optional<SegmentLaw> law_;  // of the segment entered last
  std::optional<SegmentSensitivity> sensitivity_;
  Cvode solver_;
  LawState<double> state_;
  std::vector<Slope> slopes_;           // of state_; none once its path is no longer smooth in them
  std::vector<Slope> slopes_at_start_;  // of the unknowns at_start_
  bool follows_ = false;  // s_r, see model/memory.hpp
  bool jammed_ = true;
  double nu_J_ = 0;  // while unjammed: where it jams again
  std::vector<PathEvent> events_;
  int events_in_place_ = 0;  // since e_ last moved
  Unknowns at_start_{};      // of the solver's run
  double e_start_ = 0;
  bool started_ = false;
  int index_ = 0;
  double e_ = 0, jammed_until_ = 0;
};

}  // namespace grainlaw::predict
