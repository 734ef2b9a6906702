#include "dem/foreign/particle_series.hpp"

#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "dem/engine/averages.hpp"
#include "dem/export/snapshot.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

const Deviator<double> kNoDeviator = Deviator<double>::Zero();
constexpr double kSame = 1e-12;

/// Averages of the engine and those of the same packing written, and read as somebody else's, must be the same but for the
/// order of sums: 1e-12 of each tensor.
class ParticleSeriesTest : public testing::TemporaryFolder {
 protected:
  /// Overlapping spheres in motion in a tilted cell that moves; contacts across all faces.
  State moving_state(const Material& material) {
    State state = scene::random_state(400, 3, 0.8, scene::random_shape(1.5, 0.6, draw_), draw_, material);
    scene::random_velocities(state.packing, 5, draw_);
    for (std::int64_t& id : state.packing.id) id = 3 * id + 5;  // with gaps
    return state;
  }

  static Observation observed(const State& state, const Eigen::Matrix3d& L) {
    EngineOptions options = scene::engine_options();
    options.refuse_deep_overlaps = false;
    const CellMotion motion{state.packing.H, L, Transport::homogeneous};
    return observe(Simulation(state, options, motion), motion, kNoDeviator);
  }

  ParticleSeries read(const Json& particles) {
    return read_particles(particle_request(particles, folder_, "map.json"), {});
  }

  Json lammps(bool contacts = true) {
    Json json{{"format", "lammps-dump"}, {"files", {"spheres.dump"}}, {"stiffness", 1e8}, {"density", 2000}};
    if (contacts) json["contacts"] = {{"files", {"contacts.dump"}}};
    return json;
  }

  static void expect_same(const Observation& a, const Observation& b, bool energy_too = true) {
    const auto close = [](const Eigen::Matrix3d& x, const Eigen::Matrix3d& y, const char* what) {
      EXPECT_LE((x - y).norm(), kSame * y.norm()) << what;
      EXPECT_GT(y.norm(), 0) << what;
    };
    close(a.stress.tensor, b.stress.tensor, "stress");
    close(a.fabric.tensor, b.fabric.tensor, "fabric");
    close(a.stress_kinetic.tensor, b.stress_kinetic.tensor, "kinetic stress");
    for (const auto member : {&Observation::nu, &Observation::P_star, &Observation::s_dev, &Observation::F_v,
                              &Observation::F_dev, &Observation::C_r, &Observation::C, &Observation::C_star,
                              &Observation::rattler_fraction, &Observation::mean_overlap, &Observation::E_kin})
      EXPECT_NEAR(a.*member, b.*member, kSame * std::abs(b.*member));
    if (energy_too) {
      EXPECT_NEAR(a.E_pot, b.E_pot, kSame * b.E_pot);
    }
  }

  scene::Draw draw_{7};
};

TEST_F(ParticleSeriesTest, ForcesThatAreGivenMakeOurAverages) {
  const State state = moving_state({2000, 1e8, 2, 0.1});
  Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
  L.diagonal() << -300, 100, 50;
  const Snapshot snapshot = snapshot_of(state, L);
  put("spheres.dump", lammps_dump(snapshot));
  put("contacts.dump", lammps_contacts(snapshot));
  const ParticleSeries series = read(lammps());
  ASSERT_EQ(series.rows.size(), 1u);
  expect_same(series.rows[0], observed(state, L), false);
  EXPECT_EQ(series.packing.particles, 400);
  EXPECT_NEAR(series.packing.mean_radius, mean_radius(state.packing), 1e-15);
  EXPECT_TRUE(std::isnan(series.rows[0].E_pot)) << "forces need not be elastic";
}

TEST_F(ParticleSeriesTest, TheDeclaredLawMakesOurAverages) {
  const State state = moving_state({2000, 1e8, 2, 0.1});
  put("spheres.dump", lammps_dump(snapshot_of(state, Eigen::Matrix3d::Zero())));
  Json json = lammps(false);
  json["contact_viscosity"] = 2;
  expect_same(read(json).rows[0], observed(state, Eigen::Matrix3d::Zero()));
  State elastic = state;
  elastic.material.contact_viscosity = 0;
  json.erase("contact_viscosity");
  const Observation of_elastic = observed(elastic, Eigen::Matrix3d::Zero());
  expect_same(read(json).rows[0], of_elastic);

  put("packing.xyz", xyz_frame(snapshot_of(state, Eigen::Matrix3d::Zero())));
  json["format"] = "xyz", json["files"] = {"packing.xyz"};
  expect_same(read(json).rows[0], of_elastic);
  put("packing.vtp", vtp_spheres(snapshot_of(state, Eigen::Matrix3d::Zero())));
  json["format"] = "vtk", json["files"] = {"packing.vtp"};
  expect_same(read(json).rows[0], of_elastic);
}

// Axes in another order and spheres under other names: the same packing seen by somebody else.
TEST_F(ParticleSeriesTest, PermutedAxesAndNamesPermuteTheTensors) {
  State state = scene::random_state(200, 3, 0.8, scene::random_shape(1.5, 0, draw_), draw_);
  scene::random_velocities(state.packing, 5, draw_);
  const Snapshot snapshot = snapshot_of(state, Eigen::Matrix3d::Zero());
  Eigen::Matrix3d turn;  // (x, y, z) -> (y, z, x)
  turn << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  const Packing& p = snapshot.packing;
  const Eigen::Vector3d edges = turn * p.H.diagonal();
  const auto name = [](std::size_t i) { return static_cast<int>((i * 7919 + 11) % 200); };
  std::string spheres = "# z y x name diam vx vy vz\n", contacts = "a,b,fz,fy,fx\n";
  for (std::size_t k = 0; k < p.size(); ++k) {
    const std::size_t i = (k * 37) % p.size();
    const Eigen::Vector3d x = turn * snapshot.position(i), v = turn * snapshot.velocity(i);
    spheres += fmt::format("{} {} {} {} {} {} {} {}\n", x[2], x[1], x[0], name(i), 2 * p.radius[i], v[0], v[1], v[2]);
  }
  for (const SnapshotContact& c : snapshot.contacts) {
    const Eigen::Vector3d f = turn * c.force;
    contacts += fmt::format("{},{},{},{},{}\n", name(c.j), name(c.i), f[2], f[1], f[0]);
  }
  put("s.txt", spheres);
  put("c.csv", contacts);
  const Json json{
      {"format", "table"},
      {"files", {"s.txt"}},
      {"stiffness", 1e8},
      {"density", 2000},
      {"cell", {edges[0], edges[1], edges[2]}},
      {"columns", {{"id", "name"}, {"diameter", "diam"}}},
      {"contacts",
       {{"format", "table"}, {"files", {"c.csv"}}, {"first", "a"}, {"second", "b"}, {"force_on", "second"}}}};
  Observation turned = observed(state, Eigen::Matrix3d::Zero());
  for (Eigen::Matrix3d* tensor : {&turned.stress.tensor, &turned.fabric.tensor, &turned.stress_kinetic.tensor})
    *tensor = turn * *tensor * turn.transpose();
  expect_same(read(json).rows[0], turned, false);
}

// One contact, across a face of the cell: sigma = f l/V whether it is listed once or by both spheres.
TEST_F(ParticleSeriesTest, ContactAcrossAFaceCountsOnce) {
  put("s.txt", "id x y z r\n1 0.0005 0.005 0.005 0.001\n2 0.0087 0.005 0.005 0.001\n");
  const Json json{{"format", "table"},
                  {"files", {"s.txt"}},
                  {"stiffness", 1e5},
                  {"cell", {0.01, 0.01, 0.01}},
                  {"contacts", {{"format", "table"}, {"files", {"c.txt"}}}}};
  const double expected = 20 * 1.8e-3 / 1e-6;
  for (const char* list : {"id1 id2 fx fy fz\n1 2 20 0 0\n", "id1 id2 fx fy fz\n1 2 20 0 0\n2 1 -20 0 0\n",
                           "id1 id2 fx fy fz\n2 1 -20 0 0\n1 2 0 0 0\n"}) {
    put("c.txt", list);
    const Observation row = read(json).rows[0];
    EXPECT_NEAR(row.stress.tensor(0, 0), expected, 1e-9 * expected) << list;
    EXPECT_EQ(row.C_r, 1) << list;
  }
  Json by_law = json;
  by_law.erase("contacts");
  EXPECT_NEAR(read(by_law).rows[0].stress.tensor(0, 0), expected, 1e-9 * expected) << "k delta = 1e5 0.2e-3 = 20";
}

// The tangential part counts in the stress, what is not symmetric in it is left out and told.
TEST_F(ParticleSeriesTest, TangentialForcesAreAdded) {
  put("s.txt", "id x y z r\n1 0.004 0.005 0.005 0.001\n2 0.0058 0.005 0.005 0.001\n");
  put("c.txt", "id1 id2 fx fy fz tx ty tz\n1 2 -20 0 0 0 4 0\n");
  const Json json{{"format", "table"},
                  {"files", {"s.txt"}},
                  {"stiffness", 1e5},
                  {"cell", {0.01, 0.01, 0.01}},
                  {"contacts", {{"format", "table"}, {"files", {"c.txt"}}, {"tangential_force", {"tx", "ty", "tz"}}}}};
  const ParticleSeries series = read(json);
  const Eigen::Matrix3d& sigma = series.rows[0].stress.tensor;
  EXPECT_NEAR(sigma(0, 0), 20 * 1.8e3, 1e-7);
  EXPECT_NEAR(sigma(0, 1), -4 * 1.8e3 / 2, 1e-7);
  EXPECT_EQ(sigma(0, 1), sigma(1, 0));
  EXPECT_NE(series.notes[2].find("mixed up"), std::string::npos) << series.notes[2];
}

// eps = ln of the stretches, time = step dt, I = rate 2<r> sqrt(rho/P).
TEST_F(ParticleSeriesTest, StrainsAreThoseOfTheCell) {
  State state = scene::random_state(50, 2, 0.8, Eigen::Matrix3d::Identity(), draw_);
  const Eigen::Vector3d direction(-1, 0.25, 0.5);
  const Eigen::Matrix3d H_0 = state.packing.H;
  std::string dump;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d stretch = (0.01 * k * direction).array().exp();
    state.packing.H = stretch.asDiagonal() * H_0;
    state.step = static_cast<std::uint64_t>(100 * k);
    std::string frame = lammps_dump(snapshot_of(state, Eigen::Matrix3d::Zero()));
    dump += frame.substr(frame.find("ITEM: TIMESTEP"));  // without its time
  }
  put("spheres.dump", dump);
  Json json = lammps(false);
  json["time_step"] = 1e-5;
  const ParticleSeries series = read(json);
  ASSERT_EQ(series.rows.size(), 4u);
  for (int k = 0; k < 4; ++k) {
    const Observation& row = series.rows[static_cast<std::size_t>(k)];
    EXPECT_NEAR(row.time, 1e-3 * k, 1e-15);
    const Eigen::Vector3d strain = 0.01 * k * direction;
    EXPECT_LE((row.strain.tensor - Eigen::Matrix3d(strain.asDiagonal())).norm(), 1e-14);
    EXPECT_NEAR(row.nu, 0.8 * std::exp(-strain.sum()), 1e-12);
    EXPECT_NEAR(row.shear_path, deviatoric_norm(Eigen::Vector3d(0.01 * k * direction).asDiagonal()), 1e-14);
    const double rate = std::max(0.25, deviatoric_norm(Eigen::Vector3d(direction).asDiagonal())) * 0.01 / 1e-3;
    const double P = row.stress.tensor.trace() / 3;
    EXPECT_NEAR(row.inertial_number, rate * 2 * mean_radius(state.packing) * std::sqrt(2000 / P),
                1e-9 * row.inertial_number);
  }
  EXPECT_FALSE(series.sheared);

  state.packing.H(0, 1) = 0.01 * H_0(1, 1);
  put("spheres.dump", dump + lammps_dump(snapshot_of(state, Eigen::Matrix3d::Zero())).substr(0));
  const ParticleSeries sheared = read(json);
  EXPECT_TRUE(sheared.sheared);
  EXPECT_TRUE(std::isnan(sheared.rows[4].eps_vol));
  EXPECT_GT(sheared.rows[4].P_star, 0) << "averages stay";
}

TEST_F(ParticleSeriesTest, ContactsThatCannotBeAreRefused) {
  const auto text = [&](const std::string& contacts) {
    put("s.txt", "id x y z r\n1 0.0005 0.005 0.005 0.001\n2 0.0087 0.005 0.005 0.001\n3 0.005 0.005 0.005 0.001\n");
    put("c.txt", "id1 id2 fx fy fz\n" + contacts);
    const Json json{{"format", "table"},
                    {"files", {"s.txt"}},
                    {"stiffness", 1e5},
                    {"cell", {0.01, 0.01, 0.01}},
                    {"contacts", {{"format", "table"}, {"files", {"c.txt"}}}}};
    return testing::refusal([&] { read(json); });
  };
  EXPECT_EQ(text("1 2 20 0 0\n"), "accepted");
  const std::map<std::string, std::string> refused{
      {"1 2 20 0 0\n1 2 20 0 0\n", "listed twice in the same sense (lines 2 and 3)"},
      {"1 2 20 0 0\n2 1 -10 0 0\n", "the forces are not opposite"},
      {"1 3 20 0 0\n", "line 2) has a force, but the spheres do not touch"},
      {"", "overlap by 0.1 of their radii but no contact"},
      {"1 2 -20 0 0\n", "\"force_on\": \"second\""},
      {"1 2 4 20 0\n", "do not follow the contacts"},
      {"1 7 20 0 0\n", "line 2, column 'id2': no sphere of the frame has the id 7"},
      {"1 2 nan 0 0\n", "line 2, column 'fx': is no finite number"},
      {"1 2 20 0\n", "line 2: has 4 words where there are 5 titles"}};
  for (const auto& [contacts, why] : refused)
    EXPECT_NE(text(contacts).find("c.txt"), std::string::npos) << contacts << text(contacts);
  for (const auto& [contacts, why] : refused)
    EXPECT_NE(text(contacts).find(why), std::string::npos) << contacts << text(contacts);
}

TEST_F(ParticleSeriesTest, FramesThatDoNotFitAreRefused) {
  const std::string good = "id x y z r\n1 .001 .001 .001 .001\n2 .006 .006 .006 .001\n";
  Json json{{"format", "table"}, {"files", {"a.txt", "b.txt"}}, {"stiffness", 1e5}, {"cell", {0.01, 0.01, 0.01}}};
  put("a.txt", good);
  const auto text = [&](const std::string& second) {
    put("b.txt", second);
    return testing::refusal([&] { read(json); });
  };
  EXPECT_EQ(text(good), "accepted");
  EXPECT_NE(text("id x y z r\n1 .001 .001 .001 .001\n").find("b.txt: does not have the spheres of the first"),
            std::string::npos);
  EXPECT_NE(text("id x y z r\n1 .001 .001 .001 .001\n2 .006 .006 .006 .0011\n").find("sphere 2 has another radius"),
            std::string::npos);
  EXPECT_NE(
      text("id x y z r\n1 .001 .001 .001 .001\n1 .006 .006 .006 .001\n").find("line 3, column 'id': 1 is doubled"),
      std::string::npos);
  EXPECT_NE(text("id x y z\n1 .001 .001 .001\n").find("has no radii among id, x, y, z"), std::string::npos);
  EXPECT_NE(text("id x y z r\n1 .001 nan .001 .001\n2 .006 .006 .006 .001\n").find("line 2, column 'y'"),
            std::string::npos);
  EXPECT_NE(text("id x y z r\n1 1 1 1 1\n2 6 6 6 1\n").find("does not fit a cell"), std::string::npos);
  EXPECT_NE(text("id x y z r\n1 .001 .001 .001 -.001\n2 .006 .006 .006 .001\n").find("column 'r': is not positive"),
            std::string::npos);
  EXPECT_NE(text("id x y z r\n1.5 .001 .001 .001 .001\n").find("is no integer"), std::string::npos);
  EXPECT_NE(text("id x y z r\n1 .001 .001 .001 .001\n2 .001 .001 .001 .001\n").find("b.txt: spheres 1 and 2 share one"),
            std::string::npos);
  EXPECT_NE(text("1 2 3 4\n").find("names no columns"), std::string::npos);
  EXPECT_NE(text("").find("b.txt: line 1: the file is empty"), std::string::npos);
  put("b.txt", good);
  json["times"] = {1.0};
  EXPECT_NE(testing::refusal([&] { read(json); }).find("there are 1 times"), std::string::npos);
  json["times"] = {1.0, 2.0, 3.0};
  EXPECT_NE(testing::refusal([&] { read(json); }).find("times: 3 for 2 frames"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::dem
