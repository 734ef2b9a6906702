// LAMMPS and the engine on the same spheres at one instant: the force on each sphere, the contact stress, the contacts
// and the fabric. Packings of 800 spheres, w = 3, relaxed at nu = 0.70 and 0.82; at rest, with random velocities (so that
// gamma and gamma_b count), and in a cell that shears and compresses (so that L x_ij counts).
//
// Bound. Nothing but rounding may differ. A coordinate carries a few roundings of the cell's edge h (the product H s, the
// shift of an image; the data file has all digits), 4 eps h in all. A contact makes 4 eps k h of it, and a sphere has fewer
// than 64 contacts at w = 3; what velocities add is smaller by gamma v/(k h) = 1e-5. So forces may differ by 64 times
// 4 eps k h, which is less than 1e-10 of the mean contact force here; the stress, a mean over contacts, by 4 eps k h over
// the mean force; the fabric, a mean of n n, by 4 eps h/<r>. The counts must be equal.

#include <fmt/format.h>

#include <limits>

#include "dem/engine/averages.hpp"
#include "dem/statics/relax.hpp"
#include "tests/referee/lammps.hpp"
#include "tests/support/dem_compression.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::referee {
namespace {

using dem::scene::Draw;
constexpr double kEps = std::numeric_limits<double>::epsilon();

struct Scene {
  std::string name;
  double nu = 0.70;
  double largest_velocity = 0;                     // component of the random velocities [m/s]
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // diagonal of L [1/s]
  bool drag = true;                                // the referee's drag knows v + L (x - x_c) only, so not with L
};

/// What both say of one scene.
struct Seen {
  std::vector<Eigen::Vector3d> force;  // contact force and drag on each sphere [N]
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero(), fabric = Eigen::Matrix3d::Zero();
  double contacts = 0, backbone_spheres = 0, backbone_contacts = 0;  // M, N4, M4
  double mean_force = 0;                                             // of a contact, elastic [N]
};

Eigen::Matrix3d symmetric(double xx, double yy, double zz, double xy, double xz, double yz) {
  Eigen::Matrix3d a;
  a << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return a;
}

Seen seen_by_engine(const dem::State& state, const dem::CellMotion& motion, bool drag) {
  dem::EngineOptions in_double;
  in_double.precision = dem::Precision::full;
  dem::Simulation sim(state, in_double, motion);
  const Observation row = dem::observe(sim, motion, {});
  const dem::Packing& p = sim.state().packing;
  const std::vector<dem::Row> force = dem::scene::contact_forces(state, motion);
  Seen seen;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d contact_force(force[i][0], force[i][1], force[i][2]);
    seen.force.push_back(drag ? dem::scene::force_on(sim, i) : contact_force);
  }
  const auto n = static_cast<double>(p.size());
  seen.stress = row.stress.tensor;
  seen.fabric = row.fabric.tensor;
  seen.contacts = row.C_r * n;
  seen.backbone_spheres = (1 - row.rattler_fraction) * n;
  seen.backbone_contacts = row.C * n;
  seen.mean_force = state.material.stiffness * row.mean_overlap * mean_radius(p);
  return seen;
}

Seen seen_by_lammps(const std::filesystem::path& folder, const dem::State& state, const dem::CellMotion& motion,
                    bool drag) {
  const dem::Packing& p = state.packing;
  std::string commands = packing_commands(folder, state, motion.L);
  if (drag) commands += fmt::format("fix drag all viscous {:.17g}\n", state.material.background_viscosity);
  if (motion.L.norm() > 0) {
    const Eigen::Vector3d edge_rate = (motion.L * p.H).diagonal();
    commands += fmt::format("fix cell all deform 1 x vel {:.17g} y vel {:.17g} z vel {:.17g} remap v\n", edge_rate[0],
                            edge_rate[1], edge_rate[2]);
  }
  commands +=
      "compute sigma all pressure NULL virial\n"
      "compute ids all property/local patom1 patom2 cutoff radius\n"
      "compute branch all pair/local p10 p11 p12 cutoff radius\n"
      "fix sigma all ave/time 1 1 2 c_sigma[*] file stress.txt format ' %.17g'\n"
      "dump forces all custom 2 forces.txt id fx fy fz\n"
      "dump_modify forces sort id format float %.17g\n"
      "dump contacts all local 2 contacts.txt c_ids[1] c_ids[2] c_branch[1] c_branch[2] c_branch[3]\n"
      "dump_modify contacts format float %.17g\n"
      "run 1\n";
  run_lammps(folder, commands);

  Seen seen;
  for (const auto& row : rows_of_numbers(folder / "forces.txt")) {
    if (row.size() == 4) seen.force.emplace_back(row[1], row[2], row[3]);
  }
  for (const auto& row : rows_of_numbers(folder / "stress.txt")) {
    if (row.size() == 7) seen.stress = symmetric(row[1], row[2], row[3], row[4], row[5], row[6]);
  }
  std::vector<int> count(p.size());
  for (const auto& row : rows_of_numbers(folder / "contacts.txt")) {
    if (row.size() != 5) continue;
    const Eigen::Vector3d n = Eigen::Vector3d(row[2], row[3], row[4]).normalized();
    for (const int c : {0, 1}) {
      const std::size_t i = static_cast<std::size_t>(row[static_cast<std::size_t>(c)]) - 1;
      ++count.at(i);
      seen.fabric += dem::sphere_mass({}, p.radius[i]) / dem::Material{}.density / p.volume() * n * n.transpose();
    }
  }
  for (const int c : count) {
    seen.contacts += c;
    if (c >= 4) seen.backbone_contacts += c, seen.backbone_spheres += 1;
  }
  return seen;
}

class Force : public testing::TemporaryFolder {
 protected:
  void compare(const Scene& scene) const {
    dem::State state = dem::scene::jammed({"Paper", 3, 0}, 800, scene.nu, 5);
    Draw draw(6);
    dem::scene::random_velocities(state.packing, scene.largest_velocity, draw);
    dem::CellMotion motion = dem::scene::at_rest(state);
    motion.L = scene.rate.asDiagonal();
    const Seen ours = seen_by_engine(state, motion, scene.drag);
    const Seen theirs = seen_by_lammps(folder_, state, motion, scene.drag);

    EXPECT_NEAR(theirs.contacts, ours.contacts, 1e-6);  // whole numbers
    EXPECT_NEAR(theirs.backbone_spheres, ours.backbone_spheres, 1e-6);
    EXPECT_NEAR(theirs.backbone_contacts, ours.backbone_contacts, 1e-6);
    ASSERT_EQ(theirs.force.size(), ours.force.size());
    double error = 0;
    for (std::size_t i = 0; i < ours.force.size(); ++i) {
      error = std::max(error, (theirs.force[i] - ours.force[i]).norm());
    }
    const double edge = state.packing.H.diagonal().maxCoeff();
    const double rounding = 4 * kEps * edge * state.material.stiffness / ours.mean_force;
    const auto name = [&](const char* what) { return fmt::format("LAMMPS.{}.{}", what, scene.name); };
    testing::expect_figure(name("force_error"), error / ours.mean_force, 64 * rounding);
    testing::expect_figure(name("stress_error"), (theirs.stress - ours.stress).norm() / ours.stress.norm(), rounding);
    testing::expect_figure(name("fabric_error"), (theirs.fabric - ours.fabric).norm() / ours.fabric.norm(),
                           4 * kEps * edge / mean_radius(state.packing));
  }
};

TEST_F(Force, IsThatOfLammpsAtRest) {
  if (const std::string why = lammps_missing(); !why.empty()) GTEST_SKIP() << why;
  compare({.name = "rest_0.70", .nu = 0.70});
  compare({.name = "rest_0.82", .nu = 0.82});
}

TEST_F(Force, IsThatOfLammpsWithVelocities) {
  if (const std::string why = lammps_missing(); !why.empty()) GTEST_SKIP() << why;
  compare({.name = "moving_0.70", .nu = 0.70, .largest_velocity = 2});
  compare({.name = "moving_0.82", .nu = 0.82, .largest_velocity = 2});
}

TEST_F(Force, IsThatOfLammpsInAMovingCell) {
  if (const std::string why = lammps_missing(); !why.empty()) GTEST_SKIP() << why;
  compare({.name = "sheared_0.82", .nu = 0.82, .largest_velocity = 2, .rate = {138, 20, -300}, .drag = false});
}

}  // namespace
}  // namespace grainlaw::referee
