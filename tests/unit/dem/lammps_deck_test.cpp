// Decks of LAMMPS without LAMMPS: the contact law that rows are held against, and how drives are told.
// Whether LAMMPS understands them: tests/cli/lammps.sh.

#include "dem/lammps/deck.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dem/lammps/program.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {


DeckSpheres spheres() { return {{}, {}, 1e-3}; }

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Drive drive_of(Mode mode, Profile profile) {
  const auto segments = resolve({0.7, Branch::unloading, {{mode, direction_of(mode), ExtentKind::eps_dev, 0.1}}});
  DriveOptions options;
  options.profile = profile;
  return make_drive(segments[0], options, 0.02 * Eigen::Matrix3d::Identity());
}

TEST(LammpsDeck, ContactsAreOneLine) {
  DeckSpheres s = spheres();
  EXPECT_TRUE(
      has(deck_of_data("a", s), "pair_coeff * * hooke 100000000 1 tangential linear_nohistory 0 0 damping velocity\n"));
  s.contacts.friction = 0.5;
  EXPECT_TRUE(has(deck_of_data("a", s),
                  " tangential linear_history 28571428.57142857 0.2857142857142857 0.5 damping velocity\n"));
  s.contacts.rolling_friction = 0.1;
  EXPECT_TRUE(has(deck_of_data("a", s), " rolling sds 28571428.57142857 0.2857142857142857 0.1 damping velocity\n"));
  s.contacts.normal_force = NormalForce::hertz;
  EXPECT_TRUE(has(deck_of_data("a", s), " hertz 50000000000 1 tangential mindlin "));
  s.contacts.cohesion = 3;
  EXPECT_TRUE(has(deck_of_data("a", s), " dmt 75000000000 1 0 3 tangential mindlin ")) << "3/2 K";
  EXPECT_TRUE(has(deck_of_restart("a", true, s), "read_restart a\nreset_timestep 0\n"));
  EXPECT_FALSE(has(deck_of_restart("a", false, s), "reset_timestep"));
}

TEST(LammpsDeck, OnlyEdgesThatMoveAreDriven) {
  const std::string D2 = deck_drive("cell", drive_of(Mode::D2, Profile::cosine), 1000, 50);
  EXPECT_TRUE(has(D2, "fix cell all deform 1 x variable v_dx v_rx z variable v_dz v_rz remap x\n")) << D2;
  EXPECT_TRUE(has(D2, "variable n equal step-50\n"));
  EXPECT_TRUE(has(deck_drive("cell", drive_of(Mode::UNI, Profile::constant), 1000, 0),
                  " deform 1 z variable v_dz v_rz remap x"));
  EXPECT_EQ(deck_run(120, 180, 50, 1050), "run 60 start 50 stop 1050 post no\n");
  EXPECT_TRUE(deck_keep("a").starts_with("run 0 post no\nwrite_restart a\n")) << "else springs are mixed up";
}

TEST(LammpsDeck, ProcessesEndAndAreTold) {
  const auto ended = [](Process& process) {
    while (process.running()) {
    }
    return process.how_it_ended();
  };
  Process well({"true"}, "/", 2, false), badly({"false"}, "/", 2, false);
  ended(well);
  EXPECT_TRUE(well.succeeded());
  EXPECT_EQ(ended(badly), "with exit code 1");
  EXPECT_THROW(Process({"/nowhere/lmp"}, "/", 2, false), Error);
  EXPECT_THROW(find_lammps("/nowhere/lmp", ""), InvalidInput);
}

}  // namespace
}  // namespace grainlaw::dem
