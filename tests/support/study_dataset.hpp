#pragma once
// A data set for studies of settings: packings that differ in one law, with costs.

#include "model/files/dataset.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::testing {

/// Data of packings 1, 2, 3 whose fabric limit (Eq. (20), both its terms) is `factor` times the published one, times
/// (1 + scatter (seed - 2)). Every run took 10 steps of 100 spheres and 2.5 s.
inline Dataset study_dataset(double factor, double scatter, SyntheticOptions options = {{0.70, 0.78}}) {
  Dataset all;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    LawParameters<double> law = synthetic_truth();
    const double f = factor * (1 + scatter * (static_cast<double>(seed) - 2));
    law.fabric_max.Q_c *= f;
    law.fabric_max.Q_limit *= f;
    options.seeds = {seed};
    for (TestRecord& record : SyntheticDataset(law, options).records()) {
      record.packing.particles = 100;
      all.tests.push_back({record, "", "", {10, 1e-8, 2.5}, {}});
    }
    all.seeds.push_back(seed);
  }
  return all;
}

}  // namespace grainlaw::testing
