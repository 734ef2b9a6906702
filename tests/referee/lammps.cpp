#include "tests/referee/lammps.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

namespace grainlaw::referee {
namespace {

namespace fs = std::filesystem;

double wrapped(double s) { return s - std::floor(s); }

std::string data_file(const dem::State& state, const Eigen::Matrix3d& L) {
  const dem::Packing& p = state.packing;
  const Eigen::Vector3d edge = p.H.diagonal();
  std::string text = fmt::format("a packing of grainlaw\n\n{} atoms\n1 atom types\n\n", p.size());
  const char* axes = "xyz";
  for (int a = 0; a < 3; ++a) text += fmt::format("0 {0:.17g} {1}lo {1}hi\n", edge[a], axes[a]);
  text += "\nAtoms # sphere\n\n";
  std::string velocities = "\nVelocities\n\n";
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d x = edge.cwiseProduct(Eigen::Vector3d(wrapped(p.sx[i]), wrapped(p.sy[i]), wrapped(p.sz[i])));
    const Eigen::Vector3d v = Eigen::Vector3d(p.vx[i], p.vy[i], p.vz[i]) + L * (x - edge / 2);
    text += fmt::format("{} 1 {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", i + 1, 2 * p.radius[i],
                        state.material.density, x[0], x[1], x[2]);
    velocities += fmt::format("{} {:.17g} {:.17g} {:.17g} 0 0 0\n", i + 1, v[0], v[1], v[2]);
  }
  return text + velocities;
}

std::string content(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::string lammps_missing() {
  if (std::system("command -v lmp >/dev/null 2>&1") != 0) return "lmp is not installed (Debian package lammps)";
  if (std::system("lmp -h 2>/dev/null | grep -qw GRANULAR") != 0) return "lmp has no package GRANULAR";
  return "";
}

std::string packing_commands(const fs::path& folder, const dem::State& state, const Eigen::Matrix3d& L) {
  std::ofstream(folder / "spheres.data") << data_file(state, L);
  return fmt::format(
      "units si\n"
      "atom_style sphere\n"
      "newton off\n"
      "comm_modify vel yes\n"
      "read_data spheres.data\n"
      "pair_style granular\n"
      "pair_coeff * * hooke {:.17g} {:.17g} tangential linear_nohistory 0 0 damping velocity\n"
      "neighbor {:.17g} bin\n"
      "neigh_modify delay 0 every 1 check yes\n"
      "fix motion all nve/sphere\n"
      "thermo_modify lost error\n",
      state.material.stiffness, state.material.contact_viscosity, 0.1 * mean_radius(state.packing));
}

void run_lammps(const fs::path& folder, const std::string& commands, int cores) {
  std::ofstream(folder / "in.txt") << commands;
  const std::string launcher =
      cores == 1 ? "OMPI_MCA_btl=self" : fmt::format("mpirun --allow-run-as-root --mca btl self,vader -np {}", cores);
  const std::string command = fmt::format(
      "cd '{}' && export OMP_NUM_THREADS=1 && {} lmp -in in.txt -log log.txt -screen none >out.txt 2>&1 </dev/null",
      folder.string(), launcher);
  if (std::system(command.c_str()) == 0) return;
  const std::string log = content(folder / "log.txt");
  ADD_FAILURE() << "lmp failed:\n"
                << log.substr(log.size() - std::min<std::size_t>(log.size(), 600)) << content(folder / "out.txt");
}

std::vector<std::vector<double>> rows_of_numbers(const fs::path& file) {
  std::vector<std::vector<double>> rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    double number = 0;
    while (words >> number) row.push_back(number);
    if (words.eof() && !row.empty()) rows.push_back(row);
  }
  return rows;
}

}  // namespace grainlaw::referee
