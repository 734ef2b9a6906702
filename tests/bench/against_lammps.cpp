// The engine beside Debian's LAMMPS, in turn, on the same packing, the same path and the same number of steps:
//   bench_engine [--particles N] [--tiles T] [--steps K] [--threads T] [--warm-up K] [--nu NU]... FOLDER
// Packings are prepared once and kept in FOLDER, then sheared by D2 for the steps of the warm-up before the race begins;
// --tiles repeats the packing T times along each axis; --threads T > 1 races T threads against one. Prints figures
// "NAME VALUE". Run it alone, on one pinned core (taskset -c 1) unless there are threads.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "dem/averages.hpp"
#include "dem/preparation.hpp"
#include "dem/state_file.hpp"
#include "tests/referee/lammps.hpp"

namespace {

using namespace grainlaw;
namespace fs = std::filesystem;

constexpr double kRate = 138;  // [1/s]

struct Result {
  double seconds = 0, P_star = 0, C_star = 0, E_pot = 0;
  double steps_of_a_list = 0;
};

double wrapped(double s) { return s - std::floor(s); }

dem::State packing_at(const fs::path& folder, std::int64_t particles, double nu) {
  const fs::path file = folder / fmt::format("N{}-{:.2f}.state", particles, nu);  // at rest
  if (!fs::exists(file)) {
    fs::create_directories(folder);
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

dem::Drive shear(const dem::State& state) {
  const Path path{dem::volume_fraction(state.packing), Branch::unloading,
                  {{Mode::D2, direction_of(Mode::D2, "xyz", false), ExtentKind::eps_dev, 0.3}}};
  dem::DriveOptions drive;
  drive.profile = dem::Profile::constant;
  drive.strain_rate = kRate;
  return dem::make_drive(resolve(path)[0], drive, state.packing.H);
}

/// The state after so many steps of the path, moving.
dem::State warmed_up(const dem::State& state, int steps) {
  const dem::Drive drive = shear(state);
  dem::Simulation sim = dem::start_simulation(state, {}, dem::motion_at(drive, 0));
  for (int k = 0; k < steps; ++k) {
    dem::advance(sim, dem::motion_at(drive, (k + 0.5) * sim.dt), dem::motion_at(drive, (k + 1) * sim.dt));
  }
  dem::synchronise(sim);
  dem::State warm = sim.state;
  for (auto* a : {&warm.ax, &warm.ay, &warm.az, &warm.ref_x, &warm.ref_y, &warm.ref_z}) a->clear();
  return warm;
}

/// The packing repeated `tiles` times along each axis: large without being prepared large.
dem::State tiled(const dem::State& one, int tiles) {
  dem::State all;
  all.material = one.material;
  const dem::Packing& p = one.packing;
  const auto copies = static_cast<std::size_t>(tiles * tiles * tiles);
  dem::resize(all.packing, p.size() * copies);
  dem::Packing& q = all.packing;
  q.H = p.H * tiles;
  for (std::size_t k = 0, to = 0; k < copies; ++k) {
    const auto t = static_cast<std::size_t>(tiles);
    const Eigen::Vector3d offset(static_cast<double>(k % t), static_cast<double>(k / t % t), static_cast<double>(k / t / t));
    for (std::size_t i = 0; i < p.size(); ++i, ++to) {
      q.radius[to] = p.radius[i];
      q.mass[to] = p.mass[i];
      q.sx[to] = (wrapped(p.sx[i]) + offset[0]) / tiles;
      q.sy[to] = (wrapped(p.sy[i]) + offset[1]) / tiles;
      q.sz[to] = (wrapped(p.sz[i]) + offset[2]) / tiles;
      q.vx[to] = p.vx[i];
      q.vy[to] = p.vy[i];
      q.vz[to] = p.vz[i];
    }
  }
  return all;
}

Result run_engine(const dem::State& state, const dem::EngineOptions& options, int steps) {
  const dem::Drive drive = shear(state);
  dem::Simulation sim = dem::start_simulation(state, options, dem::motion_at(drive, 0));
  const std::uint64_t rebuilds = sim.rebuilds;
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < steps; ++k) {
    dem::advance(sim, dem::motion_at(drive, (k + 0.5) * sim.dt), dem::motion_at(drive, (k + 1) * sim.dt));
  }
  Result result;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  dem::synchronise(sim);
  const Observation seen = dem::observe(sim, dem::motion_at(drive, steps * sim.dt), Deviator<double>::Zero());
  result.P_star = seen.P_star;
  result.C_star = seen.C_star;
  result.E_pot = seen.E_pot;
  result.steps_of_a_list = static_cast<double>(steps) / static_cast<double>(sim.rebuilds - rebuilds + 1);
  return result;
}

/// Of the line in LAMMPS's log that begins with `words`, the number after them.
double number_after(const std::string& log, const std::string& words) {
  const std::size_t at = log.rfind(words);
  if (at == std::string::npos) throw std::runtime_error("no '" + words + "' in LAMMPS's log");
  return std::stod(log.substr(at + words.size()));
}

Result run_lammps(const fs::path& folder, const dem::State& state, double dt, int steps) {
  fs::create_directories(folder);
  const dem::Drive drive = shear(state);
  const Eigen::Vector3d L = dem::motion_at(drive, 0).L.diagonal();
  std::string commands = referee::packing_commands(folder, state, dem::motion_at(drive, 0).L);
  commands += fmt::format("timestep {:.17g}\nfix drag all viscous {:.17g}\nfix cell all deform 1", dt, state.material.background_viscosity);
  for (int a = 0; a < 3; ++a) {
    if (L[a] != 0) commands += fmt::format(" {} trate {:.17g}", "xyz"[a], L[a]);
  }
  commands += fmt::format(
      " remap v\n"
      "compute sigma all pressure NULL virial\n"
      "compute contacts all contact/atom\n"
      "variable backbone_sphere atom c_contacts>3\n"
      "variable backbone_contacts atom c_contacts*v_backbone_sphere\n"
      "compute backbone all reduce sum v_backbone_sphere v_backbone_contacts\n"
      "run {}\n"  // timed
      "fix end all print 1 \"sigma $(c_sigma) N4 $(c_backbone[1]) M4 $(c_backbone[2])\"\n"
      "run 0\n"
      "write_dump all custom end.txt id x y z modify sort id format float %.17g\n",
      steps);
  referee::run_lammps(folder, commands);
  std::ifstream in(folder / "log.txt");
  std::ostringstream text;
  text << in.rdbuf();
  const std::string log = text.str();
  Result result;
  const std::size_t loop = log.find("Loop time of ");
  result.seconds = std::stod(log.substr(loop + 13));
  result.P_star = 2 * dem::mean_radius(state.packing) / state.material.stiffness * number_after(log, "\nsigma ");
  // LAMMPS's granular styles know no elastic energy: ours at its positions
  dem::State end = state;
  end.packing.H = dem::motion_at(drive, steps * dt).H;
  const Eigen::Vector3d corner = (state.packing.H - end.packing.H).diagonal() / 2;  // its cell deforms about the centre
  for (const auto& row : referee::rows_of_numbers(folder / "end.txt")) {
    if (row.size() != 4) continue;
    const auto i = static_cast<std::size_t>(row[0]) - 1;
    end.packing.sx[i] = (row[1] - corner[0]) / end.packing.H(0, 0);
    end.packing.sy[i] = (row[2] - corner[1]) / end.packing.H(1, 1);
    end.packing.sz[i] = (row[3] - corner[2]) / end.packing.H(2, 2);
  }
  dem::EngineOptions plain;
  plain.precision = dem::Precision::reference;
  dem::CellMotion still;
  still.H = end.packing.H;
  result.E_pot = dem::start_simulation(end, plain, still).state.sums.E_pot;
  result.C_star = number_after(log, " M4 ") / number_after(log, " N4 ");
  result.steps_of_a_list = steps / (number_after(log.substr(loop, log.find("run 0") - loop), "Neighbor list builds = ") + 1);
  return result;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("The engine beside LAMMPS");
  fs::path folder;
  std::int64_t particles = 9261, tiles = 1;
  int steps = 2000, threads = 1, warm_up = 20000;
  std::vector<double> densities{0.66, 0.82};
  bool without_lammps = false;
  app.add_option("folder", folder)->required();
  app.add_option("--particles", particles);
  app.add_option("--tiles", tiles);
  app.add_option("--steps", steps);
  app.add_option("--threads", threads);
  app.add_option("--warm-up", warm_up);
  app.add_option("--nu", densities);
  app.add_flag("--without-lammps", without_lammps);
  CLI11_PARSE(app, argc, argv);

  for (const double nu : densities) {
    const dem::State state = tiled(warmed_up(packing_at(folder, particles, nu), warm_up), static_cast<int>(tiles));
    const std::size_t all = state.packing.size();
    dem::EngineOptions options;
    const double work = 1e-6 * static_cast<double>(all) * steps;  // 10^6 particle-steps
    std::map<std::string, Result> results;
    for (const auto& [name, precision] :
         {std::pair{"mixed", dem::Precision::mixed}, {"double", dem::Precision::full}, {"reference", dem::Precision::reference}}) {
      if (precision == dem::Precision::reference && tiles > 1) continue;
      options.precision = precision;
      options.threads = 1;
      results[name] = run_engine(state, options, steps);
      if (threads == 1) continue;
      const double alone = results[name].seconds;
      options.threads = threads;
      results[name] = run_engine(state, options, steps);
      fmt::print("speedup.{}.N{}.threads{}.nu{:.2f} {:.3f}\n", name, all, threads, nu, alone / results[name].seconds);
    }
    const double dt = options.time_step_fraction * dem::min_collision_time(state.packing, state.material);
    if (!without_lammps) results["lammps"] = run_lammps(folder / "lammps", state, dt, steps);
    for (const auto& [name, r] : results) {
      const std::string id = fmt::format("{}.N{}.threads{}.nu{:.2f}", name, all, threads, nu);
      fmt::print("rate.{} {:.2f}\nP_star.{} {:.9g}\nC_star.{} {:.6g}\nsteps_of_a_list.{} {:.0f}\n", id, work / r.seconds, id, r.P_star, id,
                 r.C_star, id, r.steps_of_a_list);
      fmt::print("E_pot.{} {:.9g}\n", id, r.E_pot);
      if (name != "lammps" && !without_lammps) fmt::print("ratio.{} {:.2f}\n", id, results["lammps"].seconds / r.seconds);
    }
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_engine: {}\n", error.what());
  return 1;
}
