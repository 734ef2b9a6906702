#pragma once
// What runs would take before any is begun: work, wall time on this machine, space on disk. Nothing is written.

#include <filesystem>
#include <stop_token>
#include <vector>

#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/test_file.hpp"

namespace grainlaw::dem {

struct ExpectedCost {
  std::size_t runs = 0;       ///< preparations and tests
  std::size_t found = 0;      ///< of those, finished before
  double particle_steps = 0;  ///< of the others; relaxations count by their force passes
  double bytes = 0;           ///< on disk, of all runs and of the series copied from them [byte]
};
constexpr auto fields_of(std::type_identity<ExpectedCost>) {
  using C = ExpectedCost;
  return std::tuple{Field{&C::runs, "runs"}, Field{&C::found, "runs_found"},
                    Field{&C::particle_steps, "particle_steps"}, Field{&C::bytes, "bytes"}};
}
static_assert(tells_every_member<ExpectedCost>());

/// Of one run, from the start [particle-steps].
double expected_particle_steps(const PlannedRun& run);

/// Of `tests`; runs that are finished in `parent`/runs are found, which need not exist. Steps are those of feasibility.hpp,
/// from the mean size distribution.
ExpectedCost expected_cost(const std::vector<PlannedTest>& tests, const std::filesystem::path& parent);

/// Of simulate() into `output`, whose copies of series and states count.
ExpectedCost expected_cost(const TestFile& test, const std::filesystem::path& output);

/// Particle-steps that this machine takes per second now on `threads` threads together, one packing on each: measured for
/// about 0.4 s on packings like `like` (of 10000 spheres at most, large ones as periodic copies) that shear at a volume
/// fraction of 0.72. Throws Interrupted.
double measured_rate(const PreparationOptions& like, int threads, const std::stop_token& stop);

}  // namespace grainlaw::dem
