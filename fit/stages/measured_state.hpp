#pragma once
// A row of a test as the law's state: P*, sigma'* = sigma' 2<r>/k and F' (Eqs. (7), (8), (10)), compression positive.

#include "model/evolution.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::fit {

inline LawState<double> measured_state(const TestRecord& test, const Observation& row) {
  return {row.P_star, deviator<double>(row.stress.tensor) / test.packing.stress_unit(),
          deviator<double>(row.fabric.tensor)};
}

}  // namespace grainlaw::fit
