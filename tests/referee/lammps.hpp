#pragma once
// LAMMPS as referee: a packing of ours written for it, the same contact law in its words, runs of `lmp` in a folder of
// their own. Only the executable is needed; nothing of LAMMPS is linked.
//   Eq. (1), k delta + gamma d(delta)/dt   pair_style granular, hooke k gamma, damping velocity
//   no friction, no rotation               tangential linear_nohistory 0 0; no torque arises
//   drag -gamma_b v                        fix viscous
//   d(delta)/dt with v + L x               velocities of the data file and of periodic images: fix deform ... remap v
// The cell is orthogonal, its lower corner is 0; LAMMPS deforms a cell about its centre x_c, so a sphere has the velocity
// v + L (x - x_c). SI units on both sides.

#include <filesystem>
#include <string>
#include <vector>

#include "dem/engine/simulation.hpp"

namespace grainlaw::referee {

/// Why the referee cannot be asked; empty when `lmp` runs and has the pair style.
std::string lammps_missing();

/// What every input begins with: data file `spheres.data` in `folder` with velocities v + L (x - x_c), and the commands
/// that read it and state the contact law.
std::string packing_commands(const std::filesystem::path& folder, const dem::State& state, const Eigen::Matrix3d& L);

/// Runs the commands in `folder`, on several cores by `mpirun`. Fails the running test with the end of LAMMPS's log when it does not succeed.
void run_lammps(const std::filesystem::path& folder, const std::string& commands, int cores = 1);

/// Rows of a file that consist of numbers alone; the others are headers.
std::vector<std::vector<double>> rows_of_numbers(const std::filesystem::path& file);

}  // namespace grainlaw::referee
