#pragma once
// Time integration of a packing in a moving periodic cell: velocity Verlet on the fluctuation velocities.
//   dx/dt = v + L x, i.e. ds/dt = H^-1 v;   m dv/dt = sum f - gamma_b v;   H(t), L(t) given, not integrated
// Velocity-dependent forces use the velocity predicted to the end of the step (second order). Energy account by the
// trapezoidal rule, with the forces that act and the velocities they act on. Same bits for any number of threads: each sphere sums its own contacts in the
// order of its sorted neighbours, totals are summed in blocks of fixed size.

#include <memory>
#include <optional>
#include <variant>

#include "dem/engine/force_pass.hpp"
#include "dem/engine/lanes/lanes.hpp"
#include "dem/engine/neighbour_list.hpp"
#include "dem/engine/state.hpp"
#include "dem/engine/thread_team.hpp"
#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw::dem {

/// Arithmetic of the time steps. Rows of a series are always summed in double precision.
enum class Precision {
  mixed,      ///< positions of 32-bit fixed point, float radii, velocities and forces, totals in double
  full,       ///< positions of 52-bit fixed point, double forces
  reference,  ///< double, plain loops; also taken where the others do not fit: cells less than about five spheres
              ///< wide, sheared cells, wall-driven transport
};
constexpr auto names_of(Precision) { return std::array{"mixed", "double", "reference"}; }

struct EngineOptions {
  double time_step_fraction = 0.1;  ///< dt/t_c,min of the actual packing [-]
  double skin = 0.8;                ///< skin of the neighbour list over the mean radius, less in small cells [-]
  Precision precision = Precision::mixed;
  bool portable_bits = false;       ///< the same bits also on machines without fused multiply-add (before AVX2), slowly
  int threads = 1;                  ///< threads of one run
  bool refuse_deep_overlaps = true; ///< of pairs that nothing holds; false to watch them part (hard case D17)
};
constexpr auto fields_of(std::type_identity<EngineOptions>) {
  using E = EngineOptions;
  return std::tuple{
      Field{&E::time_step_fraction, "time_step_fraction", "", "dt/t_c",
            "time step over the shortest collision time of the packing; unstable beyond 0.4"},
      Field{&E::skin, "skin", "", "", "skin of the neighbour list over the mean radius"},
      Field{&E::precision, "precision", "", "",
            "arithmetic of the time steps: float forces, double, or double in plain loops"},
      Field{&E::portable_bits, "portable_bits", "", "",
            "the same bits also on machines without fused multiply-add (before AVX2), slowly"},
      Field{&E::threads, "threads", "", "", "threads of one run", Rule::free},
      Field{&E::refuse_deep_overlaps, "refuse_deep_overlaps", "", "", "of tests alone", Rule::free}};
}
static_assert(tells_every_member<EngineOptions>());

/// What moves with the cell.
enum class Transport {
  homogeneous,  ///< the spheres: dx/dt = v + L x
  wall,         ///< only the edges: dx/dt = v inside; a sphere that leaves re-enters with its velocity unchanged
};
constexpr auto names_of(Transport) { return std::array{"homogeneous", "wall"}; }

/// Cell and velocity gradient at an instant.
struct CellMotion {
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();  ///< cell [m], upper triangular
  Eigen::Matrix3d L = Eigen::Matrix3d::Zero();      ///< velocity gradient of the cell, dH/dt H^-1 [1/s], upper triangular
  Transport transport = Transport::homogeneous;
};

/// A state in motion: the state plus what can be recomputed from it.
struct Simulation {
  State state;              ///< while on lanes, arrays, sums and ledger are as old as the last synchronise(); the rest is current
  EngineOptions options;
  double dt = 0;            ///< time step [s], to be changed only after synchronise()
  NeighbourList list;
  std::uint64_t rebuilds = 0;      ///< of the list since the start of the simulation
  std::vector<Row> place, motion, force, viscous;  ///< of the force pass: positions with radii, velocities, contact
                                                   ///< forces and their viscous parts
  std::variant<std::monostate, Lanes<float>, Lanes<double>> lanes;  ///< what is simulated, when not the state itself
  Eigen::Matrix3d near_H = Eigen::Matrix3d::Zero();  ///< cell when the near ones were picked [m], on lanes
  std::int64_t near_step = -1;  ///< when they were, -1: not since the list was made
  double near_reach = 0;  ///< how far a sphere may have moved since the list was made, at most, while the near ones last [m]
  std::optional<CellMotion> unkicked;  ///< on lanes: end of a step whose forces wait to be taken with the next step's drift
  std::shared_ptr<ThreadTeam> team;
};

/// dt/t_c,min beyond which no run may be started; the integrator becomes unstable between 0.48 and 0.56 for w = 3.
inline constexpr double kMaxTimeStepFraction = 0.4;

/// Chooses dt = time_step_fraction * t_c,min, builds the list and, for a state without accelerations, the forces for
/// `motion` (whose H is the state's). Throws InvalidInput when dt is not positive and finite (its size is judged by
/// those who start runs), the state does not pass check(), two touching spheres share one position, or one lies deep in
/// another (overlap above the smaller radius) with nothing to balance half the force of that contact (ids are named).
Simulation start_simulation(State state, const EngineOptions& options, const CellMotion& motion);

/// One step of length dt: the cell goes from where it is to `half` (at dt/2) and `end` (at dt). Throws Error naming the
/// sphere when a position or velocity is no longer finite.
void advance(Simulation& sim, const CellMotion& half, const CellMotion& end);

/// Brings sim.state up to date after advance().
void synchronise(Simulation& sim);

/// What sums over the contacts of a simulation read, for the velocities of its state.
struct ContactView {
  NeighbourList list;
  std::vector<Row> place, motion;
  std::vector<Eigen::Vector3d> shift;
  ForceField field;  ///< points into the members above and into the simulation
};

/// Needs sim.state synchronised; sim must outlive the view, which cannot be copied.
std::unique_ptr<ContactView> view_contacts(const Simulation& sim, const CellMotion& motion);

}  // namespace grainlaw::dem
