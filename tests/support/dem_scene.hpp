#pragma once
// Small scenes for the tests of the engine: spheres given one by one, random overlapping packings in any cell, the
// cell at rest or along one straight segment.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "dem/element_tests/drive.hpp"
#include "dem/engine/lanes/lane_list.hpp"
#include "dem/engine/simulation.hpp"
#include "dem/engine/state.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::dem::scene {

/// Uniform draws that are the same on every platform.
struct Draw {
  std::mt19937_64 bits;

  explicit Draw(std::uint64_t seed) : bits(seed) {}
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53; }
  Eigen::Vector3d vector(double low, double high) {
    const double x = uniform(low, high), y = uniform(low, high), z = uniform(low, high);
    return {x, y, z};
  }
  std::size_t index(std::size_t n) { return static_cast<std::size_t>(bits() % n); }
};

struct Sphere {
  double r = 1e-3;                              ///< [m]
  Eigen::Vector3d x = Eigen::Vector3d::Zero();  ///< position [m]
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  ///< [m/s]
};

inline Eigen::Matrix3d cubic(double edge) { return edge * Eigen::Matrix3d::Identity(); }

inline void place(Packing& packing, std::size_t i, const Eigen::Vector3d& s) {
  packing.sx[i] = s.x(), packing.sy[i] = s.y(), packing.sz[i] = s.z();
}
inline void launch(Packing& packing, std::size_t i, const Eigen::Vector3d& v) {
  packing.vx[i] = v.x(), packing.vy[i] = v.y(), packing.vz[i] = v.z();
}
inline Eigen::Vector3d fraction(const Packing& p, std::size_t i) { return {p.sx[i], p.sy[i], p.sz[i]}; }
inline Eigen::Vector3d position(const Packing& p, std::size_t i) { return p.H * fraction(p, i); }
inline Eigen::Vector3d velocity(const Packing& p, std::size_t i) { return {p.vx[i], p.vy[i], p.vz[i]}; }

/// The given spheres in the cell H.
inline State state_of(const Eigen::Matrix3d& H, const std::vector<Sphere>& spheres, const Material& material = {}) {
  State state;
  state.material = material;
  state.packing.H = H;
  resize(state.packing, spheres.size());
  const Eigen::Matrix3d inverse = H.triangularView<Eigen::Upper>().solve(Eigen::Matrix3d::Identity());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    state.packing.radius[i] = spheres[i].r;
    place(state.packing, i, inverse * spheres[i].x);
    launch(state.packing, i, spheres[i].v);
  }
  set_masses(state.packing, material);
  return state;
}

/// n spheres with radii uniform on 1e-3 m 2/(w+1) [1, w] at random places of a cell with the shape of `shape`, scaled
/// to the volume fraction nu, at rest.
inline State random_state(std::size_t n, double w, double nu, const Eigen::Matrix3d& shape, Draw& draw,
                          const Material& material = {}) {
  std::vector<Sphere> spheres(n);
  for (Sphere& sphere : spheres) sphere.r = 2e-3 / (w + 1) * draw.uniform(1, w);
  State state = state_of(shape, spheres, material);
  for (std::size_t i = 0; i < n; ++i) place(state.packing, i, draw.vector(0, 1));
  scale_to_volume_fraction(state.packing, nu);
  return state;
}

inline void random_velocities(Packing& packing, double largest, Draw& draw) {
  for (std::size_t i = 0; i < packing.size(); ++i) launch(packing, i, draw.vector(-largest, largest));
}

/// Upper-triangular shape: edges between 1 and `aspect`, shears up to `shear` of the edge they lean on.
inline Eigen::Matrix3d random_shape(double aspect, double shear, Draw& draw) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (int a = 0; a < 3; ++a) H(a, a) = std::exp(draw.uniform(0, std::log(aspect)));
  H(0, 1) = draw.uniform(-shear, shear) * H(1, 1);
  H(0, 2) = draw.uniform(-shear, shear) * H(2, 2);
  H(1, 2) = draw.uniform(-shear, shear) * H(2, 2);
  return H;
}

inline CellMotion at_rest(const State& state) {
  return {state.packing.H, Eigen::Matrix3d::Zero(), Transport::homogeneous};
}

/// The precision under test: GRAINLAW_TEST_PRECISION = mixed, full (default) or reference.
inline Precision precision_under_test() {
  const char* name = std::getenv("GRAINLAW_TEST_PRECISION");
  const std::string_view chosen = name != nullptr ? name : "full";
  if (chosen == "mixed") return Precision::mixed;
  if (chosen == "reference") return Precision::reference;
  if (chosen != "full") throw std::invalid_argument("GRAINLAW_TEST_PRECISION: " + std::string(chosen));
  return Precision::full;
}

inline EngineOptions engine_options() {
  EngineOptions options;
  options.precision = precision_under_test();
  return options;
}

/// A pass line for what rounding alone leaves, given for double precision: float rounds 2^29 times as coarsely.
inline double rounding(double in_double) {
  return precision_under_test() == Precision::mixed ? in_double * 0x1p29 : in_double;
}

/// One step with the state's arrays brought up to date.
inline void step(Simulation& sim, const CellMotion& half, const CellMotion& end) {
  sim.advance(half, end);
  sim.state();
}

/// The state made ready in a cell at rest, whatever its overlaps. The forces are made anew.
inline Simulation start(State state, double time_step_fraction = 0.02, int threads = 1) {
  state.ax.clear(), state.ay.clear(), state.az.clear();
  state.ref_x.clear(), state.ref_y.clear(), state.ref_z.clear();
  const CellMotion motion = at_rest(state);
  EngineOptions options = engine_options();
  options.time_step_fraction = time_step_fraction;
  options.threads = threads;
  options.refuse_deep_overlaps = false;
  return Simulation(std::move(state), options, motion);
}

inline void advance_at_rest(Simulation& sim, std::int64_t steps) {
  const CellMotion motion = at_rest(sim.state());
  for (std::int64_t k = 0; k < steps; ++k) sim.advance(motion, motion);
  sim.state();
}

/// One segment of logarithmic strain `length` * direction from the volume fraction nu.
inline StraightSegment segment_of(const Eigen::Matrix3d& direction, double length, double nu) {
  StraightSegment segment;
  segment.mode = Mode::tensor;
  segment.direction.tensor = direction;
  segment.length = length;
  segment.nu_start = nu;
  return segment;
}

/// Runs the simulation along the drive from its start to its end in equal steps of at most the engine's, with an open
/// ledger. Returns the number of steps.
inline std::int64_t run_along(Simulation& sim, const Drive& drive) {
  const double steps = std::ceil(drive.duration / sim.dt());
  sim.set_dt(drive.duration / steps);
  sim.open_ledger();
  for (double k = 0; k < steps; ++k) {
    const double end = k + 1 < steps ? (k + 1) * sim.dt() : drive.duration;
    sim.advance(motion_at(drive, (k + 0.5) * sim.dt()), motion_at(drive, end));
  }
  sim.state();
  return static_cast<std::int64_t>(steps);
}

/// Sum of the drag-free forces m a on each sphere [N]; right where background_viscosity is 0 or all velocities vanish.
inline Eigen::Vector3d force_on(Simulation& sim, std::size_t i) {
  return sim.state().packing.mass[i] * Eigen::Vector3d(sim.state().ax[i], sim.state().ay[i], sim.state().az[i]);
}
inline Eigen::Vector3d force_on(Simulation&& sim, std::size_t i) { return force_on(sim, i); }

/// Contact forces on the spheres of a state without drag, as the plain loops take them at its start [N].
inline std::vector<Row> contact_forces(const State& state, const CellMotion& motion) {
  EngineOptions plain;
  plain.precision = Precision::reference;
  plain.refuse_deep_overlaps = false;
  return Simulation(state, plain, motion).plain()->force;
}

/// The whole list of a simulation, not only the near ones of it.
inline NeighbourList list_of(Simulation& sim) { return sim.neighbours(Listed::all); }
inline NeighbourList list_of(Simulation&& sim) { return sim.neighbours(Listed::all); }

}  // namespace grainlaw::dem::scene
