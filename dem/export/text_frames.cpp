// Extended XYZ, and the files of LAMMPS.

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "dem/export/snapshot.hpp"

namespace grainlaw::dem {
namespace {

/// The same lattice with tilts within half an edge.
Eigen::Matrix3d reduced(Eigen::Matrix3d H) {
  H.col(2) -= std::round(H(1, 2) / H(1, 1)) * H.col(1);
  H.col(2) -= std::round(H(0, 2) / H(0, 0)) * H.col(0);
  H.col(1) -= std::round(H(0, 1) / H(0, 0)) * H.col(0);
  return H;
}

bool tilted(const Eigen::Matrix3d& H) { return H(0, 1) != 0 || H(0, 2) != 0 || H(1, 2) != 0; }

/// Inside the reduced cell; as it is where that is the cell.
Eigen::Vector3d position_in(const Eigen::Matrix3d& H, const Snapshot& snapshot, std::size_t i) {
  const Eigen::Vector3d x = snapshot.position(i);
  if (H == snapshot.packing.H) return x;
  const Eigen::Vector3d s = H.inverse() * x;
  return x - H * Eigen::Vector3d(s.array().floor());
}

std::string frame_head(const Snapshot& snapshot, const char* what, std::size_t rows) {
  const Eigen::Matrix3d H = reduced(snapshot.packing.H);
  const double xy = H(0, 1), xz = H(0, 2), yz = H(1, 2);
  std::string text = fmt::format("ITEM: TIME\n{}\nITEM: TIMESTEP\n{}\nITEM: NUMBER OF {}\n{}\n", snapshot.time,
                                 snapshot.step, what, rows);
  if (!tilted(H)) return text + fmt::format("ITEM: BOX BOUNDS pp pp pp\n0 {}\n0 {}\n0 {}\n", H(0, 0), H(1, 1), H(2, 2));
  return text + fmt::format("ITEM: BOX BOUNDS xy xz yz pp pp pp\n{} {} {}\n{} {} {}\n0 {} {}\n",
                            std::min({0.0, xy, xz, xy + xz}), H(0, 0) + std::max({0.0, xy, xz, xy + xz}), xy,
                            std::min(0.0, yz), H(1, 1) + std::max(0.0, yz), xz, H(2, 2), yz);
}

}  // namespace

std::string xyz_frame(const Snapshot& snapshot) {
  const Packing& p = snapshot.packing;
  const Eigen::Matrix3d& H = p.H;
  std::string text = fmt::format(
      "{}\nLattice=\"{} {} {} {} {} {} {} {} {}\" pbc=\"T T T\" Time={} "
      "Properties=species:S:1:pos:R:3:radius:R:1:velo:R:3:id:I:1\n",
      p.size(), H(0, 0), H(1, 0), H(2, 0), H(0, 1), H(1, 1), H(2, 1), H(0, 2), H(1, 2), H(2, 2), snapshot.time);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d x = snapshot.position(i), v = snapshot.velocity(i);
    fmt::format_to(std::back_inserter(text), "X {} {} {} {} {} {} {} {}\n", x[0], x[1], x[2], p.radius[i], v[0], v[1],
                   v[2], p.id[i]);
  }
  return text;
}

std::string lammps_data(const Snapshot& snapshot) {
  const Packing& p = snapshot.packing;
  const Eigen::Matrix3d H = reduced(p.H);
  std::string text = fmt::format(
      "grainlaw, time {} s, units si, atom_style sphere\n\n{} atoms\n1 atom types\n\n"
      "0 {} xlo xhi\n0 {} ylo yhi\n0 {} zlo zhi\n",
      snapshot.time, p.size(), H(0, 0), H(1, 1), H(2, 2));
  if (tilted(H)) text += fmt::format("{} {} {} xy xz yz\n", H(0, 1), H(0, 2), H(1, 2));
  text += "\nAtoms # sphere\n\n";
  std::string velocities = "\nVelocities\n\n";
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d x = position_in(H, snapshot, i), v = snapshot.velocity(i);
    fmt::format_to(std::back_inserter(text), "{} 1 {} {} {} {} {}\n", p.id[i] + 1, 2 * p.radius[i], snapshot.density,
                   x[0], x[1], x[2]);
    fmt::format_to(std::back_inserter(velocities), "{} {} {} {} 0 0 0\n", p.id[i] + 1, v[0], v[1], v[2]);
  }
  return text + velocities;
}

std::string lammps_dump(const Snapshot& snapshot) {
  const Packing& p = snapshot.packing;
  const Eigen::Matrix3d H = reduced(p.H);
  std::string text = frame_head(snapshot, "ATOMS", p.size()) + "ITEM: ATOMS id type x y z radius vx vy vz\n";
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d x = position_in(H, snapshot, i), v = snapshot.velocity(i);
    fmt::format_to(std::back_inserter(text), "{} 1 {} {} {} {} {} {} {}\n", p.id[i] + 1, x[0], x[1], x[2], p.radius[i],
                   v[0], v[1], v[2]);
  }
  return text;
}

std::string lammps_contacts(const Snapshot& snapshot) {
  std::string text =
      frame_head(snapshot, "ENTRIES", snapshot.contacts.size()) + "ITEM: ENTRIES id1 id2 dx dy dz fx fy fz overlap\n";
  for (const SnapshotContact& c : snapshot.contacts) {
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {} {} {}\n", snapshot.packing.id[c.i] + 1,
                   snapshot.packing.id[c.j] + 1, c.branch[0], c.branch[1], c.branch[2], c.force[0], c.force[1],
                   c.force[2], c.overlap);
  }
  return text;
}

}  // namespace grainlaw::dem
