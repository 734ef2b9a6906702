#pragma once
// What a look of LAMMPS (deck_look() of dem/lammps/deck.hpp) shows: a row of a series by our own averages, of its spheres and
// the forces that it gives of their contacts, and the state. Every normal force must be that of the law that was asked for, to
// 1e-8 of the largest, with friction to 1e-4.

#include <filesystem>
#include <string>

#include "dem/engine/state.hpp"
#include "dem/lammps/deck.hpp"
#include "model/vocabulary/observation.hpp"

namespace grainlaw::dem {

struct Look {
  Observation row;                ///< but for time and place; energies of contacts and the ledger are undefined
  State state;                    ///< material, seed and ids of `like`
  double max_net_force = 0;       ///< of contacts, on a sphere [N]
  double mean_contact_force = 0;  ///< [N], 0 without contacts
};

/// Reads the files of a look in `folder`, by its line of `marks`, and removes them. `L`: velocity gradient of the cell, for the
/// inertial number alone [1/s]; `N`: direction for s_par and F_par. Throws Error naming the file for what is cut off, for
/// forces that are of another law, and for contacts that do not make the stress that LAMMPS itself has.
Look read_look(const std::filesystem::path& folder, const std::string& mark, const State& like,
               const DeckSpheres& spheres, const Eigen::Matrix3d& L, const Deviator<double>& N);

}  // namespace grainlaw::dem
