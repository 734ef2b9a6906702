#pragma once
// An element test: a packing driven along a strain path, observed at equal steps of the path parameter e. The run is one
// for both ways of following the path: in time (dem/element_tests/stepper.hpp) and, where drive.quasi_static_step > 0,
// by minimisation (dem/element_tests/stepper.hpp).

#include <functional>
#include <string>
#include <vector>

#include "dem/element_tests/drive.hpp"
#include "dem/files/checkpoint.hpp"
#include "dem/statics/relax.hpp"
#include "model/vocabulary/observation.hpp"
#include "model/vocabulary/run_control.hpp"

namespace grainlaw::dem {

class Stepper;

struct ElementTestOptions {
  EngineOptions engine;
  DriveOptions drive;
  RelaxOptions relax;                  ///< of the minimisations where drive.quasi_static_step > 0
  int rows = 200;                      ///< rows of each segment (besides the first row of the test)
  double warn_energy_residual = 1e-3;  ///< imbalance over (largest |W| so far + E_kin(0) + D) that is warned of [-]
  double stop_energy_residual = 1e-2;  ///< beyond it the test stops with Error 'energy balance' [-]
  double warn_inertial_number =
      1e-3;                     ///< beyond it the flow of a jammed packing is not quasi-static (hard case D25) [-]
  bool check_time_step = true;  ///< refuse unstable steps; false only to see the balance stop it (D16)
};

struct ElementTest {
  std::vector<Observation> rows;      ///< the first one at the start of the test
  State end;                          ///< state at the end of the path
  std::uint64_t steps = 0;            ///< time steps taken, or force passes where quasi-static
  double seconds = 0;                 ///< wall time [s]
  double time_step = 0;               ///< dt, the largest of the segments'; 0 where quasi-static [s]
  std::vector<std::string> warnings;  ///< energy residual or inertial number beyond their limits, minimisations that
                                      ///< stopped short; for the log
};

/// Sees the packing, by its stepper (dem/element_tests/stepper.hpp), after each step with the path's segment index and parameter e, e.g. to keep a state. After a continuation it sees the checkpoint's step once more.
using StepObserver = std::function<void(Stepper&, int segment, double e)>;

/// Runs `segments` (resolve() of the path at the state's own volume fraction) from `start`; time, step and ledger begin
/// at zero; `on_start` sees the packing there. A row is taken at the first step that reaches its e; `strain` is that of the step. Throws InvalidInput for
/// options out of range, Interrupted, and Error 'energy balance' (hard cases D9, D16) naming row and residual.
ElementTest run_element_test(const State& start, const std::vector<StraightSegment>& segments,
                             const ElementTestOptions& options, const RunControl& control,
                             const StepObserver& on_step = {}, const Checkpointing& checkpointing = {},
                             const StepObserver& on_start = {});

/// Goes on from a checkpoint of the same test (same segments and options but threads and checkpointing); the result is
/// the uninterrupted run's, bit for bit. Throws InvalidInput for a checkpoint that cannot be one of this test's.
ElementTest continue_element_test(Checkpoint from, const std::vector<StraightSegment>& segments,
                                  const ElementTestOptions& options, const RunControl& control,
                                  const StepObserver& on_step = {}, const Checkpointing& checkpointing = {});

/// Fills what an observation takes from the path instead of the packing: segment, strain, eps_vol, eps_dev, shear_path,
/// shape and Lode angle of strain at e of the segment with this index; `sheared_before`: shear path of the segments before
/// it [-].
void fill_path(Observation& row, const StraightSegment& segment, int index, double e, double sheared_before);

/// Deviatoric strain along the whole segment [-].
double shear_length(const StraightSegment& segment);

}  // namespace grainlaw::dem
