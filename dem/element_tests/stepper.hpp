#pragma once
// What an element test asks of the way in which its packing follows the path. There are two: in time, with the packing's
// dynamics (dem/element_tests/time_stepper.hpp), and quasi-static, by minimisation (dem/element_tests/quasi_static.hpp).

#include <cstdint>
#include <string>
#include <vector>

#include "dem/engine/simulation.hpp"
#include "model/vocabulary/error.hpp"
#include "model/vocabulary/observation.hpp"

namespace grainlaw::dem {

/// What a checkpoint that cannot be one of the test is refused with.
inline InvalidInput not_of_this_test() { return InvalidInput("the checkpoint is not one of this test; start it anew"); }

/// Takes a packing along the segments of a path, each in steps of its own length.
class Stepper {
 public:
  virtual ~Stepper() = default;

  /// Puts the packing at the start of the path; clock and ledger begin at zero.
  virtual void start(const State& state) = 0;

  /// Puts it where a checkpoint left it, `steps` having been counted until then. Throws not_of_this_test()
  /// for a state that no step of this way can have ended with.
  virtual void resume(State state, std::uint64_t steps) = 0;

  /// Steps of the segment with this index, at least 1. Throws InvalidInput where they would take years.
  virtual std::uint64_t steps_of(int segment) const = 0;

  /// Goes on along this segment, of which `done` steps are taken and at whose start the cell was H_0 [m].
  virtual void enter(int segment, const Eigen::Matrix3d& H_0, std::uint64_t done) = 0;

  /// Takes the next step of the segment. Throws Interrupted only if nothing has changed.
  virtual void step() = 0;

  virtual double place() const = 0;          ///< e, how far along the segment the packing is [-]
  virtual bool reached(int row) const = 0;   ///< whether the place of this row of the segment (1 ... rows) is reached
  virtual double fraction_done() const = 0;  ///< of the whole path [-]
  virtual std::uint64_t steps() const = 0;   ///< counted since the start of the test: time steps, or force passes
  virtual double time_step() const = 0;      ///< dt on this segment; 0 where there is none [s]

  /// The packing where it is. Valid until the next call of start(), resume(), enter() or step().
  virtual Simulation& simulation() = 0;
  virtual CellMotion motion() const = 0;  ///< of the cell at this instant
  virtual const State& state() = 0;       ///< all that a continued run needs

  /// Looks at a row of the run, each in turn; `first` is the first one. Throws Error where the results would be wrong.
  virtual void judge(const Observation& row, const Observation& first, std::size_t index, int segment) = 0;
  /// What was noticed, for the log of a run of so many rows.
  virtual std::vector<std::string> warnings(std::size_t rows) const = 0;
};

}  // namespace grainlaw::dem
