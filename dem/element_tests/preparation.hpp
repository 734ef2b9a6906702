#pragma once
// Isotropic preparation, section 3.1 of the paper: random gas -> isotropic compression to nu_start -> relaxation ->
// isotropic loading to nu_max -> isotropic unloading; states are kept at requested densities on both branches and
// relaxed. A preparation is a function of its options.

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "dem/element_tests/element_run.hpp"
#include "dem/element_tests/engine_choice.hpp"
#include "dem/element_tests/random_gas.hpp"
#include "dem/statics/relax.hpp"

namespace grainlaw::dem {

struct PreparationOptions {
  PackingOptions packing;
  EngineOptions engine;
  DriveOptions drive;
  RelaxOptions relax;
  EngineChoice choice;                 ///< what runs the particles, and what their contacts know
  double nu_gas = 0.3;                 ///< volume fraction of the random gas [-]
  double nu_start = 0.64;              ///< end of the gas compression [-]
  double nu_max = 0.82;                ///< end of the loading branch [-]
  double gas_compression_factor = 10;  ///< strain rate of the gas compression over drive.strain_rate [-]
  std::vector<double> keep_loading;    ///< densities kept on the loading branch, within [nu_start, nu_max]
  std::vector<double> keep_unloading;  ///< densities kept on the unloading branch, within [nu_start or nu_end, nu_max]
  std::optional<double> nu_end;  ///< end of the unloading branch; default: lowest of keep_unloading, else nu_start [-]
  int rows = 200;                ///< rows of each branch's series (besides the first)
};
constexpr auto fields_of(std::type_identity<PreparationOptions>) {
  using P = PreparationOptions;
  return std::tuple{Field{&P::packing, ""}, Field{&P::engine, ""}, Field{&P::drive, ""}, Field{&P::relax, ""},
                    Field{&P::choice, ""}, Field{&P::rows, "rows", "", "", "rows recorded in each segment"},
                    Field{&P::nu_gas, "nu_gas", "", "nu", "volume fraction of the random gas", Rule::fixed},
                    Field{&P::gas_compression_factor, "gas_compression_factor", "", "",
                          "strain rate of the gas compression over strain_rate", Rule::fixed},
                    Field{&P::nu_start, "nu_start", "", "nu", "volume fraction at which loading begins"},
                    Field{&P::nu_max, "nu_max", "", "nu", "volume fraction at which unloading begins"},
                    Field{&P::nu_end, "nu_end", "", "nu", "volume fraction at which unloading ends"},
                    // what is kept on the way does not change what others see of a preparation; its own key names them
                    Field{&P::keep_loading, "keep_loading", "", "", "", Rule::free},
                    Field{&P::keep_unloading, "keep_unloading", "", "", "", Rule::free}};
}
static_assert(tells_every_member<PreparationOptions>());

/// What element tests take of a preparation's options.
ElementTestOptions test_options(const PreparationOptions& options);

/// The path between two volume fractions.
std::vector<StraightSegment> isotropic_segment(double from_nu, double to_nu, bool portable = false);

/// Reports and saves under the name of a stage, with what the stages before it took added; the arguments must live on.
RunControl with_stage(const RunControl& control, const std::string& stage, double work_before = 0);
Checkpointing with_stage(const Checkpointing& checkpointing, const std::string& stage, std::uint64_t steps_before = 0,
                         double seconds_before = 0);

/// Throws InvalidInput "KEY: ..." unless the densities increase, those kept lie on their branches and the gas compression has a
/// rate.
void check(const PreparationOptions& options);

/// A state kept at a density, relaxed there.
struct KeptState {
  Branch branch = Branch::unloading;
  double nu = 0;                       ///< requested volume fraction; the state has it to rounding
  State state;                         ///< at rest, cell of exactly this density
  Relaxation relaxation;               ///< `relaxed` false: flagged, near jamming
  std::filesystem::path history = {};  ///< restart file of LAMMPS with its contacts' springs; empty: none
};

/// Receives results as they come, in order of time, so that the caller can save them.
struct PreparationSink {
  std::function<void(const KeptState&)> keep;                           ///< required
  std::function<void(Branch, const std::vector<Observation>&)> series;  ///< whole series of a branch; required
  std::function<void(const std::string&)> warn;  ///< energy or rate beyond their limits, with the stage; may be empty
  /// Whether a continued preparation delivered this state before it was interrupted; it is not made again. May be empty.
  std::function<bool(Branch, double nu)> has;
};

/// Runs the whole preparation. The branches are not interrupted by keeping: when one crosses a kept density, a copy is
/// set to exactly that density and relaxed. Checkpoints are taken along its driven stages; a relaxation or the random gas
/// that is interrupted is made again. Throws InvalidInput for options out of range, Interrupted on request.
void prepare(const PreparationOptions& options, const PreparationSink& sink, const RunControl& control,
             const Checkpointing& checkpointing = {});

/// Goes on from a checkpoint of the same preparation; what the sink gets besides what it has already is the uninterrupted
/// preparation's, bit for bit, and warnings of finished stages may come twice. Throws InvalidInput for a checkpoint that
/// cannot be one of it.
void continue_preparation(Checkpoint from, const PreparationOptions& options, const PreparationSink& sink,
                          const RunControl& control, const Checkpointing& checkpointing = {});

}  // namespace grainlaw::dem
