#pragma once
// The key `probes` of TEST and of a test of SPEC: {every, step}, where along a test its packing is probed.

#include <vector>

#include "model/files/json_document.hpp"

namespace grainlaw::dem {

struct ProbePlan {
  double every = 0;           ///< path length between two probes, integral of max(|d eps_vol|, |d eps_dev|) [-]
  std::vector<double> steps;  ///< h of the finite steps [-]
};

/// `object` has passed its schema.
ProbePlan probes_from_json(const Json& object);
OrderedJson probes_to_json(const ProbePlan& plan);

}  // namespace grainlaw::dem
