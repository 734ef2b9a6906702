#pragma once
// What an element test asks of the way in which its packing follows the path. There are two: in time, with the
// packing's dynamics (time_stepper.cpp), and quasi-static, by minimisation (quasi_static.cpp).

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "dem/element_tests/element_run.hpp"
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

// --- In time: the cell follows dem/element_tests/drive.hpp, the spheres their equations of motion
// (dem/engine/simulation.hpp). Steps of a segment are equal and rounded up in number, so that segments end exactly and
// dt is at most the engine's. A corner is a jump of the velocity gradient: forces are computed anew there. The run is
// stopped where its energies are out of balance, and warned of where it is no longer quasi-static.

/// `segments` and `options` must outlive the stepper. Steps are time steps. start() and resume() throw InvalidInput for
/// a segment that the engine cannot follow or that would take more than 1e12 steps; judge() throws Error 'energy
/// balance' naming row and residual.
std::unique_ptr<Stepper> make_time_stepper(const std::vector<StraightSegment>& segments,
                                           const ElementTestOptions& options);

// --- Without dynamics: the cell is deformed in small affine steps, each followed by a minimisation of the elastic
// energy at fixed cell (athermal quasi-static shear, e.g. Maloney and Lemaître, Phys. Rev. E 74, 016118 (2006)). It is
// the limit of vanishing rate of the way in time, but for which minimum of several a packing falls into.
//   H_k = exp(e_k D) H_0, e_k = k length/steps, spheres move with the cell, then dem/statics/relax.hpp
//   W_box grows by the change of elastic energy in the affine step, D_contact by what the minimisation takes
// Spheres are at rest in every row, the inertial number is 0, and time is that of a constant strain_rate, for the name
// only.

/// Affine steps of a segment: of at most quasi_static_step, so many that every row ends one. Throws InvalidInput beyond
/// 1e9.
std::uint64_t quasi_static_steps(const StraightSegment& segment, const DriveOptions& drive, int rows);

/// For options.drive.quasi_static_step > 0; `segments` and `options` must outlive the stepper. Its steps of a segment
/// are affine steps, its steps() force passes. Steps whose minimisation did not reach options.relax.tolerance are
/// warned of. Throws InvalidInput for wall-driven transport; start() and step() throw Interrupted when `stop` is
/// requested.
std::unique_ptr<Stepper> make_quasi_static_stepper(const std::vector<StraightSegment>& segments,
                                                   const ElementTestOptions& options, const std::stop_token& stop);

}  // namespace grainlaw::dem
