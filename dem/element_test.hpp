#pragma once
// An element test: a packing driven along a strain path, observed at equal steps of the path parameter.

#include "dem/drive.hpp"
#include "model/observation.hpp"
#include "model/run_control.hpp"

namespace grainlaw::dem {

struct ElementTestOptions {
  EngineOptions engine;
  DriveOptions drive;
  int rows = 200;                    ///< rows of each segment (besides the first row of the test)
  double warn_energy_residual = 1e-3;  ///< see energy_residual()
  double stop_energy_residual = 1e-2;  ///< beyond it the test stops with Error 'energy balance'
};

struct ElementTest {
  std::vector<Observation> rows;   ///< the first one at the start of the test
  State end;                       ///< state at the end of the path
  std::uint64_t steps = 0;         ///< time steps taken
  double seconds = 0;              ///< wall time [s]
  double time_step = 0;            ///< dt [s]
  std::vector<std::string> warnings;  ///< energy residual or inertial number beyond their limits, for the log
};

/// Runs `segments` (resolve() of the path at the state's own volume fraction) from `start`; time, step and ledger begin
/// at zero. Steps per segment are rounded up so that segments end exactly; dt is at most the engine's.
/// `on_step` (may be empty) sees the simulation after each step with the path's segment index and parameter e, e.g. to
/// keep a state. Throws Error 'energy balance' (hard case D9, D16), InvalidInput, Interrupted.
using StepObserver = std::function<void(const Simulation&, int segment, double e)>;
ElementTest run_element_test(const State& start, const std::vector<StraightSegment>& segments,
                             const ElementTestOptions& options, const RunControl& control, const StepObserver& on_step = {});

}  // namespace grainlaw::dem
