#pragma once
// A state as other programs want to see it: spheres inside the cell, and every contact once with its force.

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "dem/engine/state.hpp"

namespace grainlaw::dem {

struct SnapshotContact {
  std::size_t i = 0, j = 0;  ///< places in the packing, i <= j
  Eigen::Vector3d branch;    ///< x_i - x_j of the touching images [m]
  Eigen::Vector3d force;     ///< on i along the normal, Eq. (1) or by the state's contacts [N]
  double overlap = 0;        ///< [m]
};

struct Snapshot {
  Packing packing;  ///< wrapped into the cell
  std::vector<SnapshotContact> contacts;
  double density = 0;  ///< [kg/m^3]
  double time = 0;     ///< [s]
  std::uint64_t step = 0;

  Eigen::Vector3d position(std::size_t i) const {
    return packing.H * Eigen::Vector3d(packing.sx[i], packing.sy[i], packing.sz[i]);
  }
  Eigen::Vector3d velocity(std::size_t i) const { return {packing.vx[i], packing.vy[i], packing.vz[i]}; }
};

/// `L`: velocity gradient of the cell at that instant, of which viscous forces know [1/s]. Throws Error when two touching
/// spheres share one position.
Snapshot snapshot_of(const State& state, const Eigen::Matrix3d& L);

/// The pieces of the line from x_i to x_i - l inside the cell: it leaves through a face and comes back through the opposite one.
std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pieces_in_cell(const Snapshot& snapshot,
                                                                        const SnapshotContact& contact);

// Whole files, as text. Lengths [m], times [s], forces [N]; every number reads back equal.

/// Spheres as points with id, radius, velocity; cell and time as field data.
std::string vtp_spheres(const Snapshot& snapshot);
/// Contacts as lines, in pieces at the cell's faces, with ids, force on i, its size, overlap; "piece" counts those of a contact.
std::string vtp_contacts(const Snapshot& snapshot);
/// A collection of files, each at its time.
std::string pvd(const std::vector<std::pair<double, std::string>>& files);

/// One frame of extended XYZ, as ASE and OVITO read it.
std::string xyz_frame(const Snapshot& snapshot);

// LAMMPS, units si; ids count from 1, the first is our 0. Tilts are brought within half an edge, as LAMMPS demands.

/// For read_data with atom_style sphere, one type of atoms.
std::string lammps_data(const Snapshot& snapshot);
/// One frame of a dump custom of the spheres, and of a dump local of the contacts.
std::string lammps_dump(const Snapshot& snapshot);
std::string lammps_contacts(const Snapshot& snapshot);

}  // namespace grainlaw::dem
