// What a step of the engine costs with more threads, and in larger scenes, beside one thread and one packing of 9261 spheres:
//   bench_scaling --threads T|--tiles T [--rounds K] [--warm-up K] [--nu NU]... FOLDER
// Packings are prepared once and kept in FOLDER, then sheared by D2 for the steps of the warm-up. Both settings take turns in one process, so that a
// machine whose speed changes from minute to minute slows both alike.
//   --threads: both take the same 140 steps from the same state, again and again. A step has the same work each time, so its
//     faster repeats are those in which nobody else took a processor, and its time is their first decile (steps with a new list
//     included). Prints "speedup.PRECISION.NU VALUE", of the sums over the steps, and "disturbed.", of all repeats as they were; and
//     "ceiling.", what T runs of one thread each, side by side, win over one: more than that the machine has not to give at that hour.
//   --tiles: the packing repeated T times along each axis, one thread, turns of some 50 ms. Its steps are too long to find
//     undisturbed ones: processor time counts. Prints "cost.PRECISION.NU VALUE", of the sums over all turns.
// Run it alone, --tiles on a pinned core (taskset -c 0).

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <numeric>
#include <thread>

#include "tests/bench/sheared_packing.hpp"

namespace {

using namespace grainlaw;

constexpr std::int64_t kSpheres = 9261;

struct Pair {
  double alone = 0, other = 0;  // [s] of a sphere and step
};

/// Wall time of each step in each repeat.
struct Steps {
  std::vector<std::vector<double>> seconds = std::vector<std::vector<double>>(140);

  void repeat(const dem::State& state, const dem::EngineOptions& options) {
    bench::Sheared shear = bench::start_shear(state, options);
    bench::advance(shear, 10);  // fills the caches
    for (std::vector<double>& repeats : seconds) repeats.push_back(bench::advance(shear, 1));
  }

  double mean() const {
    double sum = 0;
    for (const auto& repeats : seconds)
      sum += std::accumulate(repeats.begin(), repeats.end(), 0.0) / static_cast<double>(repeats.size());
    return sum / static_cast<double>(seconds.size());
  }

  double undisturbed() const {
    double sum = 0;
    for (std::vector<double> repeats : seconds) {
      std::sort(repeats.begin(), repeats.end());
      sum += repeats[repeats.size() / 10];
    }
    return sum / static_cast<double>(seconds.size());
  }
};

struct Threads {
  Pair undisturbed, disturbed;
  double side_by_side = 0;  // [s] undisturbed, of as many runs of one thread together
};

Threads compare_threads(const dem::State& state, dem::EngineOptions options, int threads, int rounds) {
  Steps alone, other;
  std::vector<Steps> side_by_side(static_cast<std::size_t>(threads));
  for (int k = 0; k < rounds; ++k) {
    options.threads = 1;
    alone.repeat(state, options);
    std::vector<std::jthread> runs;
    for (Steps& run : side_by_side) runs.emplace_back([&] { run.repeat(state, options); });
    runs.clear();
    options.threads = threads;
    other.repeat(state, options);
  }
  const double rate = std::accumulate(side_by_side.begin(), side_by_side.end(), 0.0,
                                      [](double sum, const Steps& run) { return sum + 1 / run.undisturbed(); });
  return {{alone.undisturbed() / kSpheres, other.undisturbed() / kSpheres},
          {alone.mean() / kSpheres, other.mean() / kSpheres},
          1 / rate / kSpheres};
}

double processor_time(bench::Sheared& shear, int steps) {
  const std::clock_t began = std::clock();
  bench::advance(shear, steps);
  return static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
}

Pair compare_sizes(const dem::State& state, const dem::EngineOptions& options, int tiles, int rounds) {
  constexpr int kStepsOfATurn = 300;  // of one packing
  const int copies = tiles * tiles * tiles, steps_of_other = std::max(1, kStepsOfATurn / copies);
  bench::Sheared alone = bench::start_shear(state, options),
                 other = bench::start_shear(dem::tiled(state, tiles), options);
  bench::advance(alone, kStepsOfATurn);
  bench::advance(other, steps_of_other);
  Pair seconds;
  for (int k = 0; k < rounds; ++k) {
    seconds.alone += processor_time(alone, kStepsOfATurn);
    seconds.other += processor_time(other, steps_of_other);
  }
  const double spheres = static_cast<double>(kSpheres) * rounds;
  return {seconds.alone / (spheres * kStepsOfATurn), seconds.other / (spheres * copies * steps_of_other)};
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("What a step costs with more threads and in larger scenes");
  std::filesystem::path folder;
  int threads = 1, tiles = 1, rounds = 80, warm_up = 20000;
  std::vector<double> densities{0.66, 0.82};
  app.add_option("folder", folder)->required();
  CLI::Option_group* other = app.add_option_group("the other setting");
  other->add_option("--threads", threads)->check(CLI::PositiveNumber);
  other->add_option("--tiles", tiles)->check(CLI::PositiveNumber);
  other->require_option(1);
  app.add_option("--rounds", rounds)->check(CLI::PositiveNumber);
  app.add_option("--warm-up", warm_up);
  app.add_option("--nu", densities);
  CLI11_PARSE(app, argc, argv);

  for (const double nu : densities) {
    const dem::State state = bench::warmed_up(bench::packing_at(folder, kSpheres, nu), warm_up);
    for (const auto& [name, precision] :
         {std::pair{"mixed", dem::Precision::mixed}, {"double", dem::Precision::full}}) {
      dem::EngineOptions options;
      options.precision = precision;
      const auto print = [&, name = name](const char* figure, double value) {
        fmt::print("{}.{}.nu{:.2f} {:.3f}\n", figure, name, nu, value);
      };
      if (other->get_option("--threads")->count() > 0) {
        const Threads times = compare_threads(state, options, threads, rounds);
        print("speedup", times.undisturbed.alone / times.undisturbed.other);
        print("disturbed", times.disturbed.alone / times.disturbed.other);
        print("ceiling", times.undisturbed.alone / times.side_by_side);
        print("ns", 1e9 * times.undisturbed.alone);
      } else {
        const Pair times = compare_sizes(state, options, tiles, rounds);
        print("cost", times.other / times.alone);
        print("ns", 1e9 * times.alone);
      }
    }
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_scaling: {}\n", error.what());
  return 1;
}
