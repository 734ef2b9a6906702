#pragma once
// Time integration of a packing in a moving periodic cell: velocity Verlet on the fluctuation velocities.
//   dx/dt = v + L x, i.e. ds/dt = H^-1 v;   m dv/dt = sum f - gamma_b v;   H(t), L(t) given, not integrated
// Velocity-dependent forces use the velocity predicted to the end of the step (second order). Energy account by the
// trapezoidal rule, with the forces that act and the velocities they act on. Same bits for any number of threads: each sphere
// sums its own contacts in the order of its sorted neighbours, totals are summed in blocks of fixed size.

#include <memory>
#include <variant>

#include "dem/engine/lanes/lane_engine.hpp"
#include "dem/engine/plain_engine.hpp"

namespace grainlaw::dem {

/// dt/t_c,min beyond which no run may be started; the integrator becomes unstable between 0.48 and 0.56 for w = 3.
inline constexpr double kMaxTimeStepFraction = 0.4;

/// Throws InvalidInput unless the step is positive, at most kMaxTimeStepFraction of the collision time of the lightest
/// pair, and stable with its damping (stable_time_step of a pair 1.5 times lighter: a sphere has several contacts).
void check_time_step(double time_step_fraction, const Material& material, double lightest_pair);

/// A state in motion, stepped by one of the two engines. An engine may keep its own copy of the spheres and leave the end of
/// a step undone; whoever asks for the state gets it current, whole, and the asking changes no bit of what follows.
class Simulation {
 public:
  /// Chooses dt = time_step_fraction * t_c,min, builds the list and, for a state without accelerations, the forces for
  /// `motion` (whose H becomes the state's). Throws InvalidInput when dt is not positive and finite (its size is judged by
  /// those who start runs, by check_time_step()), state or material do not pass check() or check_sizes(), the cell's motion is
  /// not finite, two touching spheres share one position, or one lies deep in
  /// another (overlap above the smaller radius) with nothing to balance half the force of that contact (ids are named).
  Simulation(State state, const EngineOptions& options, const CellMotion& motion);

  /// One step of length dt: the cell goes from where it is to `half` (at dt/2) and `end` (at dt). Throws Error naming the
  /// sphere when a position or velocity is no longer finite.
  void advance(const CellMotion& half, const CellMotion& end);

  /// The state at the current time. To be asked for anew after advance(), which leaves what was handed out behind.
  const State& state();

  /// Gives the state away; the simulation is over.
  State take_state();

  /// Opens the energy account anew at the current state: ledger zero, E_start taken.
  void open_ledger();

  /// Sets the time step [s].
  void set_dt(double dt);

  // What is known without bringing the state up to date:
  double dt() const { return stepping_.dt; }                                 ///< time step [s]
  std::uint64_t step() const { return stepping_.state.step; }                ///< steps since the start of the run
  double time() const { return stepping_.state.time; }                       ///< since the start of the run [s]
  const Eigen::Matrix3d& cell() const { return stepping_.state.packing.H; }  ///< H [m]
  std::uint64_t rebuilds() const { return stepping_.rebuilds; }              ///< of the neighbour list since the start
  const EngineOptions& options() const { return stepping_.options; }
  ThreadTeam& team() const { return *stepping_.team; }

  /// All pairs of the neighbour list, or on lanes those picked from it for the present forces.
  NeighbourList neighbours(Listed which);

  /// The engine that takes the steps, for tests and measurements; null for the one that does not.
  const PlainEngine* plain() const { return std::get_if<PlainEngine>(&engine_); }
  const LaneEngine* lanes() const { return std::get_if<LaneEngine>(&engine_); }

 private:
  void bring_up_to_date();
  Drifted first_half(const Eigen::Matrix3d& start_H, const CellMotion& half, const CellMotion& end);
  void renew_list(const CellMotion& end);

  Stepping stepping_;
  std::variant<PlainEngine, LaneEngine> engine_;
  bool current_ = true;  // all of the state, not only what is known without bringing it up to date
};

/// The contacts of the simulation at the current time, for its present velocities. To be used before the next step.
std::unique_ptr<ContactView> view_contacts(Simulation& sim, const CellMotion& motion);

}  // namespace grainlaw::dem
