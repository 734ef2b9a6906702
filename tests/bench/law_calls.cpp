// law_calls PARAMETERS.json: what a prediction in memory and a batch cost in C++, for tests/bench/python_law.py to stand beside.
// Prints "NAME NUMBER" lines: microseconds of a call, the least of many; seconds of a batch, the least of five.

#include <chrono>
#include <cstdio>
#include <functional>
#include <thread>

#include "model/parameters_file.hpp"
#include "predict/predict.hpp"
#include "predict/studies/strain_batch.hpp"
#include "predict/studies/walker.hpp"

using namespace grainlaw;

namespace {

/// The least of `repeats` [s].
double least_seconds(int repeats, const std::function<void()>& work) {
  double least = 1e300;
  for (int i = 0; i < repeats; ++i) {
    const auto begun = std::chrono::steady_clock::now();
    work();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
  }
  return least;
}

constexpr std::size_t kPaths = 100000;
constexpr double kStart = 0.71, kStrain = 0.02;

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const CalibratedLaw law = read_parameters(argv[1]).law;
  Path path{kStart, Branch::unloading, {{Mode::UNI, direction_of(Mode::UNI), ExtentKind::eps_dev, kStrain}}};
  const auto segments = resolve(path);
  for (const Rung rung : {Rung::reduced, Rung::evolution}) {
    for (const int points : {1, 200}) {
      const double seconds = least_seconds(3000, [&] {
        const auto at = predict::uniform_points(segments, points);
        const auto start = predict::state_from_law(law.parameters, path.nu);
        predict::predict(rung, law.parameters, law.coupling, segments, start, at, {}, law.range, {});
      });
      std::printf("%s.%d %.4f\n", to_string(rung).c_str(), points, 1e6 * seconds);
    }
  }
  // paths that differ, as in python_law.py
  std::vector<double> strain(6 * kPaths, 0.0), nu(kPaths, kStart);
  std::vector<predict::BatchPath> paths;
  const LawState<double> start = predict::state_from_law(law.parameters, kStart);
  for (std::size_t i = 0; i < kPaths; ++i) {
    const double axial = kStrain * (1 + static_cast<double>(i) / kPaths) / 2;
    strain[6 * i + 2] = -axial;
    PathSegment segment{Mode::UNI, direction_of(Mode::UNI), ExtentKind::eps_dev, axial};
    paths.push_back({{resolve(segment, 0, kStart, {})}, start});
  }
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  std::printf("batch.arrays %.4f\n", least_seconds(5, [&] {
    predict::states_along({kPaths, 1, strain.data(), nu.data()}, law.parameters, Rung::evolution, law.coupling, 1e-8, threads, {});
  }));
  std::printf("batch.segments %.4f\n", least_seconds(5, [&] {
    predict::walk_batch(paths, predict::Integrator::dopri_5, 1e-8, law.parameters, Rung::evolution, law.coupling, threads, {});
  }));
}
