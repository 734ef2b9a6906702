#pragma once
// One strain-controlled path by one of several integrators, without outputs on the way: what a user material needs, what
// the study of work against precision compares. Set up once, walked many times; and batches of such paths over the cores.

#include <memory>
#include <vector>

#include "model/law.hpp"
#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/path.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw::predict {

/// adams, bdf: CVODE; erk_n: explicit Runge-Kutta of order n by ARKODE, both with error control in the unknowns of
/// segment_law.hpp; dopri_5: the order 5 of these inlined (dormand_prince.hpp). euler: forward Euler in equal substeps, in P, sigma', F' themselves, as in common user materials.
enum class Integrator { adams, bdf, erk_2, erk_3, erk_4, erk_5, erk_6, erk_8, dopri_5, euler };
constexpr auto names_of(Integrator) {
  return std::array{"adams", "bdf", "erk_2", "erk_3", "erk_4", "erk_5", "erk_6", "erk_8", "dopri_5", "euler"};
}
inline constexpr auto kIntegrators = kValues<Integrator>;

struct Walk {
  std::vector<LawState<double>> ends;  ///< state at the end of each segment
  long rhs_evaluations = 0;            ///< of this path
  long steps = 0;                      ///< of this path; attempts, where a step is repeated
};

class Walker {
 public:
  /// `accuracy`: relative tolerance in [1e-14, 1), the absolute one being 1e-4 of it; for euler the longest substep,
  /// |strain| by the norm of its six components.
  Walker(Integrator integrator, double accuracy, const LawParameters<double>& parameters, Rung rung, Coupling coupling,
         long most_steps = 10'000'000);
  ~Walker();
  Walker(const Walker&) = delete;
  Walker& operator=(const Walker&) = delete;

  /// From `start`, jammed, to the end of `segments`. Where shear turns within a segment (Rung::memory), that is walked as
  /// predict() does, but by euler, which turns the state before each substep. Throws NotConverged where the solver fails.
  Walk walk(const std::vector<StraightSegment>& segments, const LawState<double>& start);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One of many independent paths.
struct BatchPath {
  std::vector<StraightSegment> segments;
  LawState<double> start;  ///< jammed
};

/// State at the end of each path, in their order. Every path is walked by itself, so the results do not depend on `threads`. `integrator` and `accuracy` as for Walker. Throws what the first
/// failing path of a thread throws, and Interrupted.
std::vector<LawState<double>> walk_batch(const std::vector<BatchPath>& paths, Integrator integrator, double accuracy,
                                         const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                                         int threads, const RunControl& control);

}  // namespace grainlaw::predict
