#include "dem/lammps/lammps_preparation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "dem/lammps/frame_row.hpp"

namespace grainlaw::dem {
namespace {

constexpr const char* kGas = "gas compression";  // the first word of a stage is the name of its files
constexpr int kRowsOfGas = 20;
constexpr std::uint64_t kStepsOfRest = 5000;
constexpr int kMostRests = 6;        // of so many steps, before a state is flagged
constexpr double kAtRest = 1e-3;     // max net force over mean contact force
constexpr double kUntouched = 1e-8;  // or over k <r>: an unjammed packing

/// A packing, and LAMMPS's own file of it in the scratch folder.
struct Held {
  State state;
  std::string restart;
};

class LammpsPreparation {
 public:
  LammpsPreparation(const LammpsPlace& place, const PreparationOptions& options, const PreparationSink& sink,
                    const RunControl& control, const Checkpointing& checkpointing)
      : place_(place), options_(options), sink_(sink), control_(control), checkpointing_(checkpointing) {}

  void run(std::optional<Checkpoint> from) {
    const std::string stage = from ? from->stage : "";
    if (!stage.empty() && stage != kGas && !find_value<Branch>(stage))
      throw InvalidInput(fmt::format("checkpoint: '{}' is no stage of a preparation; start it anew", stage));
    Held held;
    if (stage.empty() || stage == kGas) held = compress(stage.empty() ? std::nullopt : std::move(from));
    if (stage != to_string(Branch::unloading))
      held = branch(Branch::loading, std::move(held), options_.nu_max, options_.keep_loading,
                    stage == to_string(Branch::loading) ? std::move(from) : std::nullopt);
    branch(Branch::unloading, std::move(held), *options_.nu_end, options_.keep_unloading,
           stage == to_string(Branch::unloading) ? std::move(from) : std::nullopt);
  }

 private:
  Held compress(std::optional<Checkpoint> from) {
    State gas;
    if (!from) gas = random_gas(options_.packing, options_.nu_gas, options_.engine, control_);
    LammpsTest test = test_of("gas");
    test.options.drive.strain_rate *= options_.gas_compression_factor;
    test.options.rows = kRowsOfGas;
    test.flow = true;
    Held held = drive(test, {gas, ""}, options_.nu_start, std::move(from), kGas).first;
    bring_to_rest(held, options_.nu_start, "start");
    return held;
  }

  LammpsTest test_of(const std::string& name) const {
    LammpsTest test;
    test.name = name;
    test.options = test_options(options_);
    test.contacts = options_.choice.contacts;
    return test;
  }

  /// An isotropic path to `to_nu`; the packing at its end, and its rows.
  std::pair<Held, std::vector<Observation>> drive(LammpsTest& test, const Held& from, double to_nu,
                                                  std::optional<Checkpoint> checkpoint, const std::string& stage) {
    State start = checkpoint ? checkpoint->state : from.state;
    Packing begin = start.packing;
    if (checkpoint) begin.H = checkpoint->segment_H;
    const double nu = volume_fraction(begin);
    test.segments = isotropic_segment(nu, to_nu);
    for (Keep& keep : test.keep) keep.e = std::abs(std::log(keep.e / nu)) / 3;  // e was the density
    test.restart = from.restart;
    LammpsResult done =
        run_lammps_test(place_, test, start, std::move(checkpoint),
                        with_stage(control_, "LAMMPS, " + stage, work_before_), with_stage(checkpointing_, stage));
    work_before_ += static_cast<double>(done.test.steps) * static_cast<double>(start.packing.size());
    if (sink_.warn) {
      for (const std::string& warning : done.test.warnings) sink_.warn(stage + ": " + warning);
    }
    return {{std::move(done.test.end), std::move(done.restart)}, std::move(done.test.rows)};
  }

  Held branch(Branch which, Held from, double to_nu, std::vector<double> densities,
              std::optional<Checkpoint> checkpoint) {
    const std::string name = to_string(which);
    std::sort(densities.begin(), densities.end());
    if (which == Branch::unloading) std::reverse(densities.begin(), densities.end());
    LammpsTest test = test_of(name);
    for (const double nu : densities) test.keep.push_back({nu, fmt::format("{}-{}.keep", name, nu)});
    auto [held, rows] = drive(test, from, to_nu, std::move(checkpoint), name);
    for (std::size_t i = 0; i < densities.size(); ++i) {
      if (sink_.has && sink_.has(which, densities[i])) continue;
      Held copy{held.state, test.keep[i].file};
      KeptState kept{which, densities[i], {}, bring_to_rest(copy, densities[i], fmt::format("{}-{}", name, i)), {}};
      kept.state = std::move(copy.state);
      if (options_.choice.has_history()) kept.history = place_.folder / copy.restart;
      sink_.keep(kept);
    }
    sink_.series(which, rows);
    return std::move(held);
  }

  /// At exactly this density; `held` becomes what it is then.
  Relaxation bring_to_rest(Held& held, double nu, const std::string& name) {
    Relaxation relaxation;
    const DeckSpheres spheres = deck_spheres(held.state, options_.choice.contacts);
    const double volume = solid_volume(held.state.packing) / nu;
    const double dt = options_.engine.time_step_fraction * min_collision_time(held.state.packing, held.state.material);
    std::string mark;
    for (int i = 0; i < kMostRests && !relaxation.relaxed; ++i) {
      const std::string look = fmt::format("rest-{}-{}", name, i), rested_file = look + ".rested";
      if (i + 1 < kMostRests && std::filesystem::exists(place_.folder / rested_file)) {  // of an earlier session
        held.restart = rested_file;
        continue;
      }
      run_deck(place_, "rest",
               deck_of_restart(held.restart, true, spheres) + deck_relaxation(volume, kStepsOfRest, dt, spheres) +
                   deck_look(look),
               control_, [&](const std::string& line) { mark = line; });
      Look rested =
          read_look(place_.folder, mark, held.state, spheres, Eigen::Matrix3d::Zero(), Deviator<double>::Zero());
      std::filesystem::rename(place_.folder / (look + ".restart"), place_.folder / rested_file);
      held = {std::move(rested.state), rested_file};
      relaxation.max_net_force = rested.max_net_force;
      relaxation.mean_contact_force = rested.mean_contact_force;
      relaxation.passes = static_cast<std::int64_t>(kStepsOfRest) * (i + 1);
      relaxation.relaxed =
          rested.max_net_force <=
          std::max(kAtRest * rested.mean_contact_force, kUntouched * spheres.material.stiffness * spheres.mean_radius);
    }
    return relaxation;
  }

  const LammpsPlace& place_;
  const PreparationOptions& options_;
  const PreparationSink& sink_;
  const RunControl& control_;
  const Checkpointing& checkpointing_;
  double work_before_ = 0;  // of the stages that are over [particle-steps]
};

}  // namespace

void prepare_with_lammps(const LammpsPlace& place, const PreparationOptions& options, const PreparationSink& sink,
                         std::optional<Checkpoint> from, const RunControl& control,
                         const Checkpointing& checkpointing) {
  if (!sink.keep || !sink.series) throw Error("preparation: its sink needs keep and series");
  PreparationOptions complete = options;
  if (!complete.nu_end) complete.nu_end = complete.nu_start;
  check(complete);
  LammpsPreparation(place, complete, sink, control, checkpointing).run(std::move(from));
}

}  // namespace grainlaw::dem
