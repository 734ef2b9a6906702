// The passes of one step, the list and a row of averages by themselves, in ns per sphere, for every kind of vector instructions
// (Google Benchmark), and what the processor does at most:
//   bench_kernels
//   bench_kernels --count        instructions per sphere of each with AVX2's vectors, by single steps (some minutes)
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "dem/engine/averages.hpp"
#include "dem/engine/lanes/lane_list.hpp"
#include "dem/engine/lanes/lane_pass.hpp"
#include "dem/engine/lanes/lane_search.hpp"
#include "dem/engine/lanes/lane_state.hpp"
#include "dem/statics/relax.hpp"
#include "tests/support/dem_scene.hpp"

namespace {

using namespace grainlaw::dem;

std::size_t spheres = 4096;

/// A relaxed packing at nu = 0.74, with what lanes need to know.
const State& packing() {
  static const State state = [] {
    scene::Draw draw(1);
    State s = scene::random_state(spheres, 3, 0.74, scene::cubic(1), draw);
    round_radii(s.packing);
    relax(s, {}, {}, {});
    s.ref_x = s.packing.sx, s.ref_y = s.packing.sy, s.ref_z = s.packing.sz, s.ref_H = s.packing.H;
    for (auto* a : {&s.ax, &s.ay, &s.az}) a->assign(spheres, 0.0);
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
    for (SphereGroup<Real>& group : lanes.group)
      std::fill(std::begin(group.near_skin), std::end(group.near_skin), static_cast<Real>(near_skin / 2));
    write_rows(lanes, step, 0, lanes.group.size());
    pick_near(lanes, step.edge, 0, lanes.group.size());
  }
};

/// Something of which one call is measured.
struct Kernel {
  std::string name;
  std::function<std::function<void()>()> prepared;  ///< the call, ready to be repeated
  std::function<double()> tiers;  ///< per sphere, sixteen pairs each, of what was prepared last; may be empty
};

template <class Real>
std::vector<Kernel> kernels_of(const std::string& precision, const std::string& target) {
  std::vector<Kernel> kernels;
  const auto scene = std::make_shared<std::unique_ptr<Scene<Real>>>();
  const auto add = [&](const std::string& name, auto pass) {
    const auto prepared = [=] {
      use_vector_target(target);
      *scene = std::make_unique<Scene<Real>>();
      return [=] { pass(**scene); };
    };
    const auto tiers = [=] {
      const auto& count = (*scene)->lanes.near_count;
      return std::accumulate(count.begin(), count.end(), 0.0) / static_cast<double>(spheres);
    };
    kernels.push_back({fmt::format("{}/{}/{}", name, precision, target), prepared, tiers});
  };
  add("force_and_kick",
      [](Scene<Real>& s) { benchmark::DoNotOptimize(force_and_kick(s.lanes, s.step, 0, s.lanes.group.size())); });
  add("kick_and_drift",
      [](Scene<Real>& s) { benchmark::DoNotOptimize(kick_and_drift(s.lanes, s.step, 0, s.lanes.group.size())); });
  add("pick_near", [](Scene<Real>& s) { pick_near(s.lanes, s.step.edge, 0, s.lanes.group.size()); });
  add("arrange", [](Scene<Real>& s) { arrange(s.lanes, s.step.edge, s.skin, s.near_skin, s.team); });
  return kernels;
}

/// The sums over contacts of one row of a series, over a list that is there.
Kernel averages() {
  return {"averages",
          [] {
            const CellMotion still{packing().packing.H, Eigen::Matrix3d::Zero()};
            const auto sim = std::make_shared<Simulation>(packing(), EngineOptions{}, still);
            return [sim, still] { benchmark::DoNotOptimize(observe(*sim, still, grainlaw::Deviator<double>::Zero())); };
          },
          {}};
}

std::vector<Kernel> all_kernels() {
  std::vector<Kernel> all;
  for (const std::string& target : vector_targets()) {
    for (const auto& of : {kernels_of<float>("mixed", target), kernels_of<double>("double", target)})
      all.insert(all.end(), of.begin(), of.end());
  }
  all.push_back(averages());
  return all;
}

void run_kernel(benchmark::State& state, const Kernel& kernel) {
  const std::function<void()> pass = kernel.prepared();
  for (auto _ : state) pass();
  state.counters["ns/sphere"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(spheres) * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  if (kernel.tiers) state.counters["tiers/sphere"] = kernel.tiers();
  use_vector_target("");
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

#ifdef __x86_64__
/// Instructions per nanosecond that do not wait for each other, half of them on integers, half on vectors, in a loop that the
/// processor need not decode anew. Eight chains of each: additions of vectors may take two cycles.
void peak_of_instructions(benchmark::State& state) {
  constexpr int kTurns = 100, kInstructions = 16 * 8;
  std::uint64_t r[8] = {};
  for (auto _ : state) {
    for (int i = 0; i < kTurns; ++i) {
      asm volatile(
          ".rept 8\n"
          "add $1, %0\n paddd %%xmm8, %%xmm0\n add $1, %1\n paddd %%xmm8, %%xmm1\n"
          "add $1, %2\n paddd %%xmm8, %%xmm2\n add $1, %3\n paddd %%xmm8, %%xmm3\n"
          "add $1, %4\n paddd %%xmm8, %%xmm4\n add $1, %5\n paddd %%xmm8, %%xmm5\n"
          "add $1, %6\n paddd %%xmm8, %%xmm6\n add $1, %7\n paddd %%xmm8, %%xmm7\n"
          ".endr\n"
          : "+r"(r[0]), "+r"(r[1]), "+r"(r[2]), "+r"(r[3]), "+r"(r[4]), "+r"(r[5]), "+r"(r[6]), "+r"(r[7])
          :
          : "xmm0", "xmm1", "xmm2", "xmm3", "xmm4", "xmm5", "xmm6", "xmm7", "xmm8", "cc");
    }
  }
  state.counters["per_ns"] = benchmark::Counter(static_cast<double>(state.iterations()) * kTurns * kInstructions * 1e-9,
                                                benchmark::Counter::kIsRate);
}
#endif

/// Of one call, which a child makes step by step.
std::int64_t instructions_of(const std::function<void()>& pass) {
  const pid_t child = fork();
  if (child == 0) {
    ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    std::raise(SIGSTOP);
    pass();
    _exit(0);
  }
  std::int64_t count = -1;  // the stop itself
  int status = 0;
  while (waitpid(child, &status, 0) == child && WIFSTOPPED(status)) {
    ++count;
    ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr);
  }
  return count;
}

int count_instructions() {
  spheres = 1000;
  for (const Kernel& kernel : all_kernels()) {
    if (kernel.tiers && !kernel.name.ends_with("/AVX2")) continue;
    const std::function<void()> pass = kernel.prepared();
    pass();  // fills its tables
    std::printf("%s %.0f\n", kernel.name.c_str(),
                static_cast<double>(instructions_of(pass)) / static_cast<double>(spheres));
    std::fflush(stdout);
    use_vector_target("");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--count") return count_instructions();
  benchmark::RegisterBenchmark("clock", clock_rate);
#ifdef __x86_64__
  benchmark::RegisterBenchmark("peak", peak_of_instructions);
#endif
  for (const Kernel& kernel : all_kernels())
    benchmark::RegisterBenchmark(kernel.name.c_str(), [kernel](benchmark::State& state) { run_kernel(state, kernel); });
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
