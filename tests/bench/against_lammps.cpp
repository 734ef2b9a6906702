// The engine beside Debian's LAMMPS, in turn, on the same packing, the same path and the same number of steps:
//   bench_engine [--particles N] [--tiles T] [--cores K] [--steps K] [--warm-up K] [--nu NU]... FOLDER
// Packings are prepared once and kept in FOLDER, then sheared by D2 for the steps of the warm-up before the race begins.
// --tiles: then repeated T times along each axis; --cores: threads of the engine, processes of LAMMPS.
// Prints figures "NAME VALUE". Run it alone, with one core on a pinned one (taskset -c 1).

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/bench/sheared_packing.hpp"
#include "tests/referee/lammps.hpp"

namespace {

using namespace grainlaw;
namespace fs = std::filesystem;

struct Result {
  double seconds = 0, P_star = 0, C_star = 0, E_pot = 0;
  double steps_of_a_list = 0;
};

Result run_engine(const dem::State& state, const dem::EngineOptions& options, int steps) {
  bench::Sheared shear = bench::start_shear(state, options);
  dem::Simulation& sim = shear.sim;
  const std::uint64_t rebuilds = sim.rebuilds();
  Result result;
  result.seconds = advance(shear, steps);
  const Observation seen = dem::observe(sim, motion_after(shear, steps), Deviator<double>::Zero());
  result.P_star = seen.P_star;
  result.C_star = seen.C_star;
  result.E_pot = seen.E_pot;
  result.steps_of_a_list = static_cast<double>(steps) / static_cast<double>(sim.rebuilds() - rebuilds + 1);
  return result;
}

/// Of the line in LAMMPS's log that begins with `words`, the number after them.
double number_after(const std::string& log, const std::string& words) {
  const std::size_t at = log.rfind(words);
  if (at == std::string::npos) throw std::runtime_error("no '" + words + "' in LAMMPS's log");
  return std::stod(log.substr(at + words.size()));
}

Result run_lammps(const fs::path& folder, const dem::State& state, const dem::Drive& drive, double dt, int steps,
                  int cores) {
  fs::create_directories(folder);
  const Eigen::Vector3d L = dem::motion_at(drive, 0).L.diagonal();
  std::string commands = referee::packing_commands(folder, state, dem::motion_at(drive, 0).L);
  commands += fmt::format("timestep {:.17g}\nfix drag all viscous {:.17g}\nfix cell all deform 1", dt,
                          state.material.background_viscosity);
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
  referee::run_lammps(folder, commands, cores);
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
  result.E_pot = dem::Simulation(end, plain, still).state().sums.E_pot;
  result.C_star = number_after(log, " M4 ") / number_after(log, " N4 ");
  result.steps_of_a_list =
      steps / (number_after(log.substr(loop, log.find("run 0") - loop), "Neighbor list builds = ") + 1);
  return result;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("The engine beside LAMMPS");
  fs::path folder;
  std::int64_t particles = 9261;
  int tiles = 1, cores = 1, steps = 2000, warm_up = 20000;
  std::vector<double> densities{0.66, 0.82};
  app.add_option("folder", folder)->required();
  app.add_option("--particles", particles);
  app.add_option("--tiles", tiles)->check(CLI::PositiveNumber);
  app.add_option("--cores", cores)->check(CLI::PositiveNumber);
  app.add_option("--steps", steps);
  app.add_option("--warm-up", warm_up);
  app.add_option("--nu", densities);
  CLI11_PARSE(app, argc, argv);

  for (const double nu : densities) {
    const dem::State state = dem::tiled(bench::warmed_up(bench::packing_at(folder, particles, nu), warm_up), tiles);
    const std::size_t size = state.packing.size();
    dem::EngineOptions options;
    options.threads = cores;
    const double work = 1e-6 * static_cast<double>(size) * steps;  // 10^6 particle-steps
    std::map<std::string, Result> results;
    for (const auto& [name, precision] : {std::pair{"mixed", dem::Precision::mixed},
                                          {"double", dem::Precision::full},
                                          {"reference", dem::Precision::reference}}) {
      if (precision == dem::Precision::reference && tiles > 1) continue;  // plain loops would take minutes
      options.precision = precision;
      results[name] = run_engine(state, options, steps);
    }
    const bench::Sheared path = bench::start_shear(state, options);
    results["lammps"] = run_lammps(folder / "lammps", state, path.drive, path.sim.dt(), steps, cores);
    for (const auto& [name, r] : results) {
      const std::string id = fmt::format("{}.N{}.nu{:.2f}", name, size, nu);
      fmt::print("rate.{} {:.2f}\nP_star.{} {:.9g}\nC_star.{} {:.6g}\nsteps_of_a_list.{} {:.0f}\n", id,
                 work / r.seconds, id, r.P_star, id, r.C_star, id, r.steps_of_a_list);
      fmt::print("E_pot.{} {:.9g}\n", id, r.E_pot);
      if (name != "lammps") fmt::print("ratio.{} {:.2f}\n", id, results["lammps"].seconds / r.seconds);
    }
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_engine: {}\n", error.what());
  return 1;
}
