// What a step of the engine costs with more threads, and in larger scenes, beside one thread and one packing of 9261 spheres:
//   bench_scaling [--threads T] [--tiles T] [--rounds K] [--warm-up K] [--nu NU]... FOLDER
// Both take turns of some 50 ms in one process, so that a machine whose speed changes from minute to minute slows both alike.
// Packings are prepared once and kept in FOLDER, then sheared by D2 for the steps of the warm-up before the turns begin; --tiles
// repeats the packing T times along each axis. Prints "speedup.PRECISION.NU VALUE" (--threads) or "cost.PRECISION.NU VALUE" (--tiles),
// of the sums over all turns, and quartiles of the turns. Run it alone, with one thread on a pinned core (taskset -c 1).

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "tests/bench/sheared_packing.hpp"

namespace {

using namespace grainlaw;

constexpr std::int64_t kSpheres = 9261;
constexpr int kStepsOfATurn = 300;  // of one packing

struct Times {
  double alone = 0, other = 0;  // [s]
  std::vector<double> ratio;    // of each turn, in order of size
};

Times take_turns(bench::Sheared& alone, bench::Sheared& other, int steps_of_other, int rounds) {
  advance(alone, kStepsOfATurn);
  advance(other, steps_of_other);
  Times times;
  for (int k = 0; k < rounds; ++k) {
    const double a = advance(alone, kStepsOfATurn), b = advance(other, steps_of_other);
    times.alone += a;
    times.other += b;
    times.ratio.push_back(a / b);
  }
  std::sort(times.ratio.begin(), times.ratio.end());
  return times;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("What a step costs with more threads and in larger scenes");
  std::filesystem::path folder;
  int threads = 1, tiles = 1, rounds = 80, warm_up = 20000;
  std::vector<double> densities{0.66, 0.82};
  app.add_option("folder", folder)->required();
  app.add_option("--threads", threads)->check(CLI::PositiveNumber);
  app.add_option("--tiles", tiles)->check(CLI::PositiveNumber);
  app.add_option("--rounds", rounds)->check(CLI::PositiveNumber);
  app.add_option("--warm-up", warm_up);
  app.add_option("--nu", densities);
  CLI11_PARSE(app, argc, argv);

  for (const double nu : densities) {
    const dem::State state = bench::warmed_up(bench::packing_at(folder, kSpheres, nu), warm_up),
                     large = bench::tiled(state, tiles);
    const int copies = tiles * tiles * tiles, steps_of_other = std::max(1, kStepsOfATurn / copies);
    for (const auto& [name, precision] :
         {std::pair{"mixed", dem::Precision::mixed}, {"double", dem::Precision::full}}) {
      dem::EngineOptions options;
      options.precision = precision;
      bench::Sheared alone = bench::start_shear(state, options);
      options.threads = threads;
      bench::Sheared other = bench::start_shear(large, options);
      const Times times = take_turns(alone, other, steps_of_other, rounds);
      // seconds of a sphere's step, alone over other
      const double per_step = static_cast<double>(steps_of_other) * copies / kStepsOfATurn;
      const auto shown = [&](double a_over_b) { return tiles > 1 ? 1 / (a_over_b * per_step) : a_over_b * per_step; };
      fmt::print("{}.{}.nu{:.2f} {:.3f}\n", tiles > 1 ? "cost" : "speedup", name, nu, shown(times.alone / times.other));
      fmt::print("quartiles.{}.nu{:.2f} {:.3f} {:.3f}\n", name, nu, shown(times.ratio[times.ratio.size() / 4]),
                 shown(times.ratio[times.ratio.size() * 3 / 4]));
      fmt::print("ns.{}.nu{:.2f} {:.2f}\n", name, nu,
                 1e9 * times.alone / (static_cast<double>(kSpheres) * kStepsOfATurn * rounds));
    }
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_scaling: {}\n", error.what());
  return 1;
}
