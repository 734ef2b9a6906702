#pragma once
// Parts of an input script of LAMMPS, for packings and paths as dem/element_tests has them. Units si, one type of spheres.
//   contacts   pair_style granular: hooke k gamma, or hertz k/2<r> gamma, or dmt with a cohesion; damping velocity
//   friction   a tangential spring of 2/7 k (Hertz: of 2/7 of the normal stiffness) and dashpot of 2/7 gamma, at most mu f_n
//   rolling    likewise a spring of 2/7 k and dashpot of 2/7 gamma against rolling (sds), at most mu_r f_n
//   drag       fix viscous gamma_b on velocities, which are fluctuations: the cell moves spheres by `remap x`
//   cell       fix deform ... variable: edges h_0 exp(e(t) D), e(t) by Eq. (2), as dem/element_tests/drive.hpp
// What is left out against dem/engine: gamma n.L.x_ij of the moving cell, some 1e-5 of a contact's force at 138 1/s. Damping
// takes velocities of half a step ago.

#include <cstdint>
#include <string>

#include "dem/element_tests/drive.hpp"
#include "dem/element_tests/engine_choice.hpp"

namespace grainlaw::dem {

/// Part of the key of runs: raised when decks change what comes out.
inline constexpr int kDeckVersion = 1;

/// What a deck is told of the spheres.
struct DeckSpheres {
  Material material;
  ContactModel contacts;
  double mean_radius = 0;  ///< <r> of the packing [m]
};

/// Reads `file`, a data file (at step 0) or a restart file (`fresh`: its counter of steps begins anew), and declares contacts and
/// motion.
std::string deck_of_data(const std::string& file, const DeckSpheres& spheres);
std::string deck_of_restart(const std::string& file, bool fresh, const DeckSpheres& spheres);

/// The cell follows `drive` in `steps` steps, of which the first is the one after LAMMPS's step `begin`; `name` must be another
/// one each time, also over restarts: LAMMPS keeps its state by it.
std::string deck_drive(const std::string& name, const Drive& drive, std::uint64_t steps, std::uint64_t begin);
std::string deck_end_of_drive(const std::string& name);

/// Goes on from one of LAMMPS's steps to another; `fixed` is where deck_drive() stands, `end` where the segment ends.
std::string deck_run(std::uint64_t from, std::uint64_t to, std::uint64_t fixed, std::uint64_t end);

/// Writes NAME.spheres, NAME.contacts and NAME.restart of this instant, then a line to the file `marks`: NAME and LAMMPS's own
/// contact stress, xx, yy, zz [Pa].
std::string deck_look(const std::string& name);

/// Writes a restart file, then its name to `marks`. As a look it begins with `run 0`: a restart file has the springs of the last
/// neighbour list, and one that is written without a new list mixes up those across the faces of the cell from then on.
std::string deck_keep(const std::string& file);

/// Scales the cell to this volume [m^3], lets strong drag bring the spheres to rest for `steps`, and stops them.
std::string deck_relaxation(double volume, std::uint64_t steps, double time_step, const DeckSpheres& spheres);

/// Columns of the dumps that deck_look() asks for.
inline constexpr const char* kFirst = "c_pair[1]";
inline constexpr const char* kSecond = "c_pair[2]";

}  // namespace grainlaw::dem
