#pragma once
// What both engines share, the plain loops (dem/engine/plain_engine.hpp) and the lanes (dem/engine/lanes/lane_engine.hpp):
// how they are asked to step, and the state that they step.

#include <memory>

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
  bool portable_bits = false;  ///< the same bits also on machines without fused multiply-add (before AVX2), slowly
  int threads = 1;             ///< threads of one run
  bool refuse_deep_overlaps = true;  ///< of pairs that nothing holds; false to watch them (D17, states at rest)
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
      Field{&E::refuse_deep_overlaps, "refuse_deep_overlaps", "", "", "overlaps that nothing holds", Rule::free}};
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
  Eigen::Matrix3d L = Eigen::Matrix3d::Zero();  ///< velocity gradient of the cell, dH/dt H^-1 [1/s], upper triangular
  Transport transport = Transport::homogeneous;
};

/// A state and what rules its steps. Which parts of the state are current is the engine's to say.
struct Stepping {
  State state;
  EngineOptions options;
  double dt = 0;               ///< time step [s]
  double r_max = 0;            ///< largest radius [m]
  double skin = 0;             ///< of the present list [m]
  std::uint64_t rebuilds = 0;  ///< of the list since the start of the simulation
  std::shared_ptr<ThreadTeam> team;
};

/// How the first half of a step, kick and drift, ended.
enum class Drifted {
  well,
  beyond_near,  ///< two spheres may touch that are not among the near ones; maybe beyond the list, where that was not in danger
  beyond_list,  ///< two spheres may touch that are not listed, or will be so when the near ones are picked the next time
  lost,         ///< a sphere moved farther in this step than an eighth of the cell, or is nowhere
};

}  // namespace grainlaw::dem
