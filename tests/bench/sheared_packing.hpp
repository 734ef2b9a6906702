#pragma once
// A packing in D2 shear, moving: what the engine's speed is measured on.

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <utility>

#include "dem/engine/averages.hpp"
#include "dem/element_tests/preparation.hpp"
#include "dem/files/state_file.hpp"

namespace grainlaw::bench {

inline constexpr double kRate = 138;  // [1/s]

/// At rest; prepared once and kept in `folder`.
inline dem::State packing_at(const std::filesystem::path& folder, std::int64_t particles, double nu) {
  const std::filesystem::path file = folder / fmt::format("N{}-{:.2f}.state", particles, nu);
  if (!std::filesystem::exists(file)) {
    std::filesystem::create_directories(folder);
    dem::PreparationOptions options;
    options.packing.particles = particles;
    options.packing.seed = 1;
    options.nu_max = 0.83;
    options.keep_unloading = {nu};
    options.nu_end = nu;
    dem::PreparationSink sink;
    sink.keep = [&](const dem::KeptState& kept) { dem::write_state(file, kept.state); };
    sink.series = [](Branch, const std::vector<Observation>&) {};
    RunControl control;
    control.report = [](const Progress& p) { fmt::print(stderr, "\r{} {:3.0f} %   ", p.stage, 100 * p.fraction); };
    dem::prepare(options, sink, control);
    fmt::print(stderr, "\n");
  }
  return dem::read_state(file);
}

struct Sheared {
  dem::Drive drive;
  dem::Simulation sim;
  int step = 0;
};

/// D2 at constant rate, up to eps_dev = 0.3.
inline Sheared start_shear(const dem::State& state, const dem::EngineOptions& options) {
  const Path path{dem::volume_fraction(state.packing),
                  Branch::unloading,
                  {{Mode::D2, direction_of(Mode::D2, "xyz", false), ExtentKind::eps_dev, 0.3}}};
  dem::DriveOptions how;
  how.profile = dem::Profile::constant;
  how.strain_rate = kRate;
  const dem::Drive drive = dem::make_drive(resolve(path)[0], how, state.packing.H);
  return {drive, dem::Simulation(state, options, dem::motion_at(drive, 0))};
}

inline dem::CellMotion motion_after(const Sheared& shear, double steps) {
  return dem::motion_at(shear.drive, steps * shear.sim.dt());
}

/// Returns what it took. [s]
inline double advance(Sheared& shear, int steps) {
  const auto began = std::chrono::steady_clock::now();
  for (const int end = shear.step + steps; shear.step < end; ++shear.step) {
    shear.sim.advance(motion_after(shear, shear.step + 0.5), motion_after(shear, shear.step + 1));
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

/// The state after so many steps of the path, moving.
inline dem::State warmed_up(const dem::State& state, int steps) {
  Sheared shear = start_shear(state, {});
  advance(shear, steps);
  dem::State warm = shear.sim.take_state();
  for (auto* a : {&warm.ax, &warm.ay, &warm.az, &warm.ref_x, &warm.ref_y, &warm.ref_z}) a->clear();
  return warm;
}

}  // namespace grainlaw::bench
