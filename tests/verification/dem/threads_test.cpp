// R1: the number of threads must not change a bit, also when there are more of them than cores. Whole states are compared
// with those of one thread: along a driven run with rebuilds of its list, through relaxation, along an element test with
// a corner, through a preparation. 4500 spheres are 18 blocks, so that 16 threads have work.

#include <gtest/gtest.h>

#include <vector>

#include "dem/element_tests/preparation.hpp"
#include "dem/engine/averages.hpp"
#include "tests/support/dem_state_bits.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using scene::bits_of;
using testing::expect_figure;

using Bits = std::vector<std::uint64_t>;
using Trace = std::vector<Bits>;  ///< one entry per state or row that is compared

const std::vector<int> kThreads{1, 2, 3, 4, 8, 16};

void append(Bits& bits, const Eigen::Matrix3d& tensor) {
  for (const double x : tensor.reshaped()) bits.push_back(std::bit_cast<std::uint64_t>(x));
}

Bits bits_of(const Observation& row) {
  Bits bits;
  for (const auto& tensor : {row.strain.tensor, row.stress.tensor, row.stress_kinetic.tensor, row.fabric.tensor}) {
    append(bits, tensor);
  }
  for (const double x :
       {row.time, row.nu, row.P_star, row.s_dev, row.F_v, row.F_dev, row.C_r, row.C, row.C_star, row.rattler_fraction,
        row.mean_overlap, row.E_kin, row.E_pot, row.W_box, row.D_contact, row.D_background, row.energy_residual}) {
    bits.push_back(std::bit_cast<std::uint64_t>(x));
  }
  return bits;
}

EngineOptions engine_of(int threads) {
  EngineOptions engine = scene::engine_options();
  engine.threads = threads;
  return engine;
}

/// Traces of `run` with each number of threads of `all`, the first of them one, held against that of one thread.
template <class Run>
void compare(const std::string& what, std::size_t expected, const Run& run, const std::vector<int>& all = kThreads) {
  std::size_t compared = 0, differing = 0;
  Trace one;
  for (const int threads : all) {
    const Trace trace = run(threads);
    EXPECT_EQ(trace.size(), expected) << threads << " threads";
    if (threads == 1) {
      one = trace;
      for (std::size_t k = 1; k < one.size(); ++k) EXPECT_NE(one[k], one[k - 1]) << "nothing moves";
      continue;
    }
    for (std::size_t k = 0; k < std::min(one.size(), trace.size()); ++k, ++compared) {
      differing += trace[k] == one[k] ? 0 : 1;
    }
  }
  const std::size_t wanted = expected * (all.size() - 1);
  expect_figure(fmt::format("R1.not_compared_of_{}.{}", wanted, what), static_cast<double>(wanted - compared), 0);
  expect_figure("R1.differing_hashes." + what, static_cast<double>(differing), 0);
}

TEST(Threads, R1DrivenRunWithRebuilds) {
  const State start = scene::bursting_packing(4500);
  DriveOptions options;
  options.strain_rate = 2e4;
  options.profile = Profile::constant;
  const Eigen::Vector3d direction(0, 0, -1);
  const Drive drive = make_drive(scene::segment_of(direction.asDiagonal(), 0.05, 0.7), options, start.packing.H);
  compare("driven", 40, [&](int threads) {
    Simulation sim = scene::start(start, 0.1, threads);
    sim.open_ledger();
    Trace trace;
    for (int k = 0; k < 80; ++k) {
      sim.advance(motion_at(drive, (k + 0.5) * sim.dt()), motion_at(drive, (k + 1) * sim.dt()));
      if (k % 2 == 0) continue;
      trace.push_back(bits_of(sim.state()));
      const Bits seen = bits_of(observe(sim, motion_at(drive, (k + 1) * sim.dt()), Deviator<double>::Zero()));
      trace.back().insert(trace.back().end(), seen.begin(), seen.end());
    }
    EXPECT_GT(sim.rebuilds(), 2U) << "the list must have been rebuilt on the way";
    return trace;
  });
}

TEST(Threads, R1Relaxation) {
  compare("relaxation", 8, [](int threads) {
    State state = scene::bursting_packing(4500);
    Trace trace;
    for (int k = 0; k < 8; ++k) {
      relax(state, engine_of(threads), RelaxOptions{1e-5, 12}, {});
      trace.push_back(bits_of(state));
    }
    return trace;
  });
}

TEST(Threads, R1ElementTestWithACorner) {
  scene::Draw draw(600);
  State start = scene::random_state(600, 3, 0.72, scene::cubic(1), draw);
  relax(start, {}, {}, {});
  const auto path = resolve({volume_fraction(start.packing),
                             Branch::unloading,
                             {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.01},
                              {Mode::UNI, direction_of(Mode::UNI), ExtentKind::eps_vol, 0.005}}});
  compare("element_test", 22, [&](int threads) {
    ElementTestOptions options;
    options.engine = scene::engine_options();
    options.engine.threads = threads;
    options.drive.strain_rate = 3000;
    options.rows = 10;
    const ElementTest test = run_element_test(start, path, options, {});
    Trace trace;
    for (const Observation& row : test.rows) trace.push_back(bits_of(row));
    trace.push_back(bits_of(test.end));
    return trace;
  });
}

TEST(Threads, R1Preparation) {
  PreparationOptions options;
  options.packing.particles = 300;  // two blocks, which more threads than two only wait for
  options.drive.strain_rate = 2e4;
  options.gas_compression_factor = 2;
  options.relax.tolerance = 1e-2;
  options.nu_max = 0.70;
  options.keep_loading = {0.68, 0.70};
  options.keep_unloading = {0.69, 0.67};
  options.rows = 10;
  compare("preparation", 26,
          [&](int threads) {
            options.engine.threads = threads;
            Trace trace;
            PreparationSink sink;
            sink.keep = [&](const KeptState& kept) { trace.push_back(bits_of(kept.state)); };
            sink.series = [&](Branch, const std::vector<Observation>& rows) {
              for (const Observation& row : rows) trace.push_back(bits_of(row));
            };
            prepare(options, sink, {});
            return trace;
          },
          {1, 2, 3, 16});
}

}  // namespace
}  // namespace grainlaw::dem
