#include "dem/runs/expected_cost.hpp"

#include <algorithm>
#include <thread>

#include "dem/engine/run_watch.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

// Measured on finished runs of 800 to 9261 spheres:
constexpr double kPassesPerRelaxation = 1500;  // force passes of the relaxation of one kept state, within a factor of 2
constexpr double kBytesPerRow = 880;           // of a series
constexpr double kBytesPerKept = 72;           // of a sphere in a kept state
constexpr double kBytesPerEnd = 120;           // of a sphere in the state at the end of a test
constexpr double kBytesPerTableRow = 140;      // of a sphere in end.csv
constexpr double kBytesPerRecord = 2500;       // of run.json

constexpr double kMeasured = 0.4;  // wall time of a measurement [s]
constexpr std::int64_t kMeasuredSpheres = 10000;
constexpr double kMeasuredWidth = 10;  // at most
constexpr std::int64_t kLarge = 8000;  // spheres; an eighth of it is a packing, too
constexpr int kTiles = 2;
constexpr double kMeasuredDensity = 0.72;

double spheres(const PreparationOptions& o) { return static_cast<double>(o.packing.particles); }
double spheres_of(const TestSetup& test) {
  return test.given ? static_cast<double>(test.given->packing.size()) : spheres(test.preparation);
}
double kept(const PreparationOptions& o) {
  return static_cast<double>(o.keep_loading.size() + o.keep_unloading.size());
}

double frames(const TestSetup& test) {
  return test.frames > 0 ? static_cast<double>(test.path.segments.size()) * test.frames + 1 : 0;
}

double bytes_of(const PlannedRun& run) {
  const PreparationOptions& o = run.test->preparation;
  if (run.is_preparation) return kBytesPerRecord + 2 * o.rows * kBytesPerRow + kept(o) * spheres(o) * kBytesPerKept;
  const double rows = static_cast<double>(run.test->path.segments.size()) * run.test->rows + 1;
  return kBytesPerRecord + rows * kBytesPerRow + (1 + frames(*run.test)) * spheres_of(*run.test) * kBytesPerEnd;
}

/// A packing that is dense at once: the gas, shrunk and relaxed roughly; a large one in periodic copies of an eighth.
State dense_packing(const PreparationOptions& like, const EngineOptions& engine, const RunControl& control) {
  PackingOptions packing = like.packing;
  packing.particles = std::min(packing.particles, kMeasuredSpheres);
  packing.size_width = std::clamp(packing.size_width, 1.0, kMeasuredWidth);
  const bool large = packing.particles >= kLarge;
  if (large) packing.particles /= kTiles * kTiles * kTiles;
  State state = random_gas(packing, like.nu_gas, engine, control);
  scale_to_volume_fraction(state.packing, kMeasuredDensity);
  relax(state, engine, {1e-2, 400}, control);
  return large ? tiled(state, kTiles) : state;
}

/// Steps per second of one run, times its spheres.
double rate_of_one(const State& state, const PreparationOptions& like, const EngineOptions& engine,
                   const std::stop_token& stop) {
  std::stop_source enough;
  const std::stop_callback forward(stop, [&] { enough.request_stop(); });
  ElementTestOptions options;
  options.engine = engine;
  options.drive = like.drive;
  options.drive.quasi_static_step = 0;
  const std::vector<StraightSegment> shear =
      resolve({kMeasuredDensity, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 1}}});
  double steps = 0, seconds = 0;
  Clock::time_point first;
  const auto count = [&](Stepper&, int, double) {
    if (steps == 0) first = Clock::now();
    ++steps;
    seconds = seconds_since(first);
    if (seconds > kMeasured) enough.request_stop();
  };
  try {
    run_element_test(state, shear, options, {{}, enough.get_token()}, count);
  } catch (const Interrupted&) {
    if (stop.stop_requested()) throw;
  }
  return static_cast<double>(state.packing.size()) * std::max(1.0, steps - 1) / seconds;
}

}  // namespace

double expected_particle_steps(const PlannedRun& run) {
  const TestSetup& test = *run.test;
  const PreparationOptions& o = test.preparation;
  if (run.is_preparation) return expected_work(o) + (kept(o) + 1) * spheres(o) * kPassesPerRelaxation;
  return expected_work(test) + (test.relax ? spheres_of(test) * kPassesPerRelaxation : 0);
}

ExpectedCost expected_cost(const std::vector<PlannedTest>& tests, const fs::path& parent) {
  ExpectedCost cost;
  for (const PlannedRun& run : runs_of(tests)) {
    ++cost.runs;
    cost.bytes += bytes_of(run);
    if (is_finished(parent / "runs", run.key))
      ++cost.found;
    else
      cost.particle_steps += expected_particle_steps(run);
  }
  for (const PlannedTest& test : tests) {
    const std::size_t segments = std::max<std::size_t>(1, test.path.segments.size());
    cost.bytes += static_cast<double>(segments) * test.rows * kBytesPerRow;  // the copy of the series
  }
  return cost;
}

ExpectedCost expected_cost(const TestFile& test, const fs::path& output) {
  const bool prepared = test.start == Start::preparation;
  ExpectedCost cost = expected_cost({{test, "", Role::validation, prepared}}, output);
  const double N = spheres_of(test);
  cost.bytes += prepared ? kept(test.preparation) * N * kBytesPerKept + 2 * test.rows * kBytesPerRow
                         : N * (kBytesPerEnd + kBytesPerTableRow) + frames(test) * N * kBytesPerEnd;
  return cost;
}

double measured_rate(const PreparationOptions& like, int threads, const std::stop_token& stop) {
  EngineOptions engine = like.engine;
  engine.threads = 1;
  const State state = dense_packing(like, engine, {{}, stop});
  std::vector<double> rates(static_cast<std::size_t>(threads));
  {
    std::vector<std::jthread> together;
    for (double& rate : rates)
      together.emplace_back([&] {
        try {
          rate = rate_of_one(state, like, engine, stop);
        } catch (const std::exception&) {
          rate = 0;  // another thread's rate serves, or none is known
        }
      });
  }
  if (stop.stop_requested()) throw Interrupted("interrupted; nothing was run");
  double sum = 0;
  for (const double rate : rates) sum += rate;
  return sum;
}

}  // namespace grainlaw::dem
