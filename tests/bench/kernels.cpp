// The passes of one step by themselves, in ns per sphere, for every kind of vector instructions (Google Benchmark):
//   bench_kernels
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <numeric>
#include <string>

#include "dem/engine/lanes/lane_list.hpp"
#include "dem/engine/lanes/lane_pass.hpp"
#include "dem/engine/lanes/lane_search.hpp"
#include "dem/engine/lanes/lane_state.hpp"
#include "dem/statics/relax.hpp"
#include "tests/support/dem_scene.hpp"

namespace {

using namespace grainlaw::dem;

constexpr std::size_t kSpheres = 4096;

/// A relaxed packing at nu = 0.74, with what lanes need to know.
const State& packing() {
  static const State state = [] {
    scene::Draw draw(1);
    State s = scene::random_state(kSpheres, 3, 0.74, scene::cubic(1), draw);
    round_radii(s.packing);
    relax(s, {}, {}, {});
    s.ref_x = s.packing.sx, s.ref_y = s.packing.sy, s.ref_z = s.packing.sz, s.ref_H = s.packing.H;
    for (auto* a : {&s.ax, &s.ay, &s.az}) a->assign(kSpheres, 0.0);
    return s;
  }();
  return state;
}

template <class Real>
struct Scene {
  ThreadTeam team{1};
  Lanes<Real> lanes;
  LaneStep step;
  double skin = 0, near_skin = 0;  // of two spheres together

  Scene() {
    const State& s = packing();
    const double r = mean_radius(s.packing), dt = 0.1 * min_collision_time(s.packing, s.material);
    lanes = make_lanes<Real>(s, dt, 0.8 * r, 0.12 * r, team);
    const Units& unit = lanes.unit;
    skin = 0.8 * r / unit.length;
    near_skin = 0.12 * r / unit.length;
    step.half_dt = dt / 2 / unit.time;
    for (std::size_t a = 0; a < 3; ++a) {
      step.edge[a] = s.packing.H(0, 0) / unit.length;
      step.drift[a] = 2 * step.half_dt / step.edge[a] * kQuantaPerEdge<Real>;
    }
    step.stiffness = s.material.stiffness / (unit.mass / unit.time / unit.time);
    step.viscosity = s.material.contact_viscosity / (unit.mass / unit.time);
    step.allowed = skin;
    step.near_stretch = skin / near_skin;
    for (SphereGroup<Real>& group : lanes.group) std::fill(std::begin(group.near_skin), std::end(group.near_skin), static_cast<Real>(near_skin / 2));
    write_rows(lanes, step, 0, lanes.group.size());
    pick_near(lanes, step.edge, 0, lanes.group.size());
  }
};

void per_sphere(benchmark::State& state) {
  state.counters["ns/sphere"] = benchmark::Counter(static_cast<double>(state.iterations()) * kSpheres * 1e-9,
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// Cycles per nanosecond, by additions that wait for each other.
void clock_rate(benchmark::State& state) {
  constexpr int kAdditions = 1000;
  for (auto _ : state) {
    std::uint64_t x = 0;
    for (int i = 0; i < kAdditions; ++i) {
      x += static_cast<std::uint64_t>(i);
      asm volatile("" : "+r"(x));  // one at a time
    }
  }
  state.counters["GHz"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kAdditions * 1e-9, benchmark::Counter::kIsRate);
}

template <class Real>
void force_and_kick_pass(benchmark::State& state, const std::string& target) {
  use_vector_target(target);
  Scene<Real> scene;
  for (auto _ : state) benchmark::DoNotOptimize(force_and_kick(scene.lanes, scene.step, 0, scene.lanes.group.size()));
  per_sphere(state);
  const auto& tiers = scene.lanes.near_count;
  state.counters["tiers/sphere"] = std::accumulate(tiers.begin(), tiers.end(), 0.0) / kSpheres;
  use_vector_target("");
}

template <class Real>
void kick_and_drift_pass(benchmark::State& state, const std::string& target) {
  use_vector_target(target);
  Scene<Real> scene;
  for (auto _ : state) benchmark::DoNotOptimize(kick_and_drift(scene.lanes, scene.step, 0, scene.lanes.group.size()));
  per_sphere(state);
  use_vector_target("");
}

template <class Real>
void pick_near_pass(benchmark::State& state, const std::string& target) {
  use_vector_target(target);
  Scene<Real> scene;
  for (auto _ : state) pick_near(scene.lanes, scene.step.edge, 0, scene.lanes.group.size());
  per_sphere(state);
  use_vector_target("");
}

template <class Real>
void arrangement(benchmark::State& state, const std::string& target) {
  use_vector_target(target);
  Scene<Real> scene;
  for (auto _ : state) arrange(scene.lanes, scene.step.edge, scene.skin, scene.near_skin, scene.team);
  per_sphere(state);
  use_vector_target("");
}

template <class Real>
void register_all(const std::string& precision, const std::string& target) {
  const auto add = [&](const std::string& name, auto function) {
    benchmark::RegisterBenchmark((name + "/" + precision + "/" + target).c_str(), [=](benchmark::State& s) { function(s, target); });
  };
  add("force_and_kick", force_and_kick_pass<Real>);
  add("kick_and_drift", kick_and_drift_pass<Real>);
  add("pick_near", pick_near_pass<Real>);
  add("arrange", arrangement<Real>);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::RegisterBenchmark("clock", clock_rate);
  for (const std::string& target : vector_targets()) {
    register_all<float>("mixed", target);
    register_all<double>("double", target);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
