// PATH and TEST files.
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include "dem/files/state_file.hpp"
#include "dem/runs/dataset_runs.hpp"
#include "dem/runs/spec_file.hpp"
#include "dem/runs/test_file.hpp"
#include "model/files/path_file.hpp"
#include "model/files/path_json.hpp"

#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

using testing::refusal;

class PathFiles : public testing::TemporaryFolder {
 protected:
  std::string path_refusal(const std::string& text) const {
    const auto file = put("p.json", text);
    return without_folder(refusal([&] { read_path(file); }));
  }
  std::string test_refusal(const std::string& text) const {
    const auto file = put("t.json", text);
    return without_folder(refusal([&] { dem::read_test(file); }));
  }
  std::string without_folder(std::string message) const {
    const std::string folder = folder_.string() + "/";
    if (const auto at = message.find(folder); at != std::string::npos) message.erase(at, folder.size());
    return message;
  }
};

TEST_F(PathFiles, GivePaths) {
  const PathFile file = read_path(
      put("p.json", R"({"initial": {"nu": 0.7, "branch": "loading"}, "seeds": [3, 4], "rows": 20, "segments": [
      {"mode": "UNI", "axes": "yzx", "extent": {"target_nu": 0.75}},
      {"mode": "D2", "reverse": true, "extent": {"eps_dev": 0.1}},
      {"rate_tensor": [[1, 0.5, 0], [0.5, 0, 0], [0, 0, -2]], "extent": {"eps_vol": 0.01}}]})"));
  EXPECT_EQ(file.path.nu, 0.7);
  EXPECT_EQ(file.path.branch, Branch::loading);
  EXPECT_EQ(file.seeds, (std::vector<std::uint64_t>{3, 4}));
  EXPECT_EQ(file.rows, 20);
  ASSERT_EQ(file.path.segments.size(), 3u);
  EXPECT_EQ(file.path.segments[0].direction.tensor, direction_of(Mode::UNI, "yzx").tensor);
  EXPECT_EQ(file.path.segments[1].direction.tensor, direction_of(Mode::D2, "xyz", true).tensor);
  EXPECT_EQ(file.path.segments[2].mode, Mode::tensor);
  EXPECT_EQ(file.path.segments[2].extent_kind, ExtentKind::eps_vol);
  EXPECT_EQ(file.path.segments[2].direction.tensor(1, 0), 0.5);

  const Path again = path_from_json(Json(path_to_json(file.path)), "p.json", "", true);
  EXPECT_EQ(path_to_json(again), path_to_json(file.path));
  EXPECT_EQ(json_text(path_to_json(file.path)).find("-0.0"), std::string::npos);
}

TEST(Examples, AreValidInput) {
  const std::filesystem::path quickstart = std::filesystem::path(GRAINLAW_SOURCE_DIR) / "examples" / "quickstart";
  const dem::Spec spec = dem::read_spec(quickstart / "spec.json");
  EXPECT_GE(spec.densities.size(), 5u);
  for (const char* name : {"uniaxial-0.695.json", "uniaxial-0.728.json"}) {
    const PathFile path = read_path(quickstart / name);
    // its packings are shared by the predictions and are none of the calibration's
    EXPECT_EQ(plan(spec, path, dem::new_seeds(spec, path, {}, {}, name), name).front().preparation.keep_unloading,
              spec.keep);
  }
}

TEST_F(PathFiles, VelocityGradientsAreRateAndSpin) {
  const PathFile file = read_path(put("p.json", R"({"initial": {"nu": 0.7}, "segments": [
      {"velocity_gradient": [[0, 0, 1], [0, 0, 0], [0, 0, 0]], "extent": {"eps_dev": 0.1}}]})"));
  const PathSegment& simple_shear = file.path.segments.at(0);
  EXPECT_EQ(simple_shear.direction.tensor(0, 2), 0.5);
  EXPECT_EQ(simple_shear.direction.tensor(2, 0), 0.5);
  EXPECT_EQ(simple_shear.spin(0, 2), 0.5);
  EXPECT_EQ(simple_shear.spin(2, 0), -0.5);
  EXPECT_EQ(path_to_json(path_from_json(Json(path_to_json(file.path)), "p.json", "", true)), path_to_json(file.path));
  EXPECT_EQ(resolve(file.path)[0].spin, simple_shear.spin);

  EXPECT_NE(path_refusal(R"({"initial": {"nu": 0.7}, "segments": [
      {"velocity_gradient": [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], "extent": {"eps_dev": 0.1}}]})")
                .find("segments[0].velocity_gradient: is zero but for its spin"),
            std::string::npos);
  EXPECT_NE(test_refusal(R"({"initial": {"nu": 0.7}, "segments": [
      {"velocity_gradient": [[0, 0, 1], [0, 0, 0], [0, 0, 0]], "extent": {"eps_dev": 0.1}}]})")
                .find("t.json: segments[0]: the engine deforms the cell along its axes only"),
            std::string::npos);
}

TEST_F(PathFiles, CyclesBecomeLegs) {
  const auto strains = [&](const std::string& segment) {
    std::vector<double> corners{0};
    for (const StraightSegment& s :
         resolve(read_path(put("p.json", R"({"initial": {"nu": 0.7}, "segments": [)" + segment + "]}")).path)) {
      // D2 has eps_zz = -eps_dev/sqrt3, ISO eps_zz = eps_vol/3
      corners.push_back(s.strain(s.length).tensor(2, 2));
    }
    return corners;
  };
  const auto expect = [](const std::vector<double>& got, const std::vector<double>& wanted) {
    ASSERT_EQ(got.size(), wanted.size());
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], wanted[i], 1e-15) << i;
  };
  const double a = 0.05 / std::numbers::sqrt3;
  expect(strains(R"({"mode": "D2", "cycles": {"amplitude": 0.05, "count": 2}})"), {0, -a, a, -a, a, 0});
  expect(strains(R"({"mode": "D2", "reverse": true, "cycles": {"amplitude": 0.05, "count": 1}})"), {0, a, -a, 0});
  expect(strains(R"({"mode": "D2", "cycles": {"amplitude": 0.05, "count": 2, "one_sided": true}})"), {0, -a, 0, -a, 0});
  expect(strains(R"({"mode": "ISO", "cycles": {"amplitude": 0.06, "count": 1, "one_sided": true}})"), {0, -0.02, 0});

  EXPECT_EQ(dem::read_test(put("t.json", R"({"initial": {"nu": 0.7}, "segments": [
      {"mode": "D2", "cycles": {"amplitude": 0.05, "count": 3}}]})"))
                .path.segments.size(),
            7u);
  const auto refused = [&](const std::string& segment) {
    return path_refusal(R"({"initial": {"nu": 0.7}, "segments": [)" + segment + "]}");
  };
  EXPECT_NE(refused(R"({"mode": "D2", "cycles": {"amplitude": 0.1, "count": 1}, "extent": {"eps_dev": 0.1}})")
                .find("segments[0]: has extent and cycles"),
            std::string::npos);
  EXPECT_NE(
      refused(R"({"mode": "D2", "cycles": {"amplitude": 0.1, "count": 0}})").find("segments[0].cycles.count: got 0"),
      std::string::npos);
  EXPECT_NE(refused(R"({"mode": "D2", "cycles": {"count": 1}})").find("misses the key 'amplitude'"), std::string::npos);
  // what is written can be read again, however many legs it has
  const std::string many = R"({"mode": "D2", "cycles": {"amplitude": 1e-3, "count": 1000}})";
  EXPECT_NE(refused(fmt::format("{0}, {0}, {0}, {0}, {0}", many))
                .find("segments[4].cycles: with these the path has 10005 straight pieces, more than 10000"),
            std::string::npos);
  EXPECT_EQ(refused(fmt::format("{0}, {0}, {0}, {0}", many)), "accepted");
}

TEST_F(PathFiles, FreeRatesKeepToConditions) {
  const std::string triaxial = R"({"initial": {"nu": 0.7}, "segments": [{"mode": "UNI", "extent": {"eps_dev": 0.1},
      "free": {"xx": {"quantity": "stress"}, "yy": {"quantity": "stress", "rate": 0.01}}}]})";
  const PathFile file = read_path(put("p.json", triaxial));
  const auto& conditions = file.path.segments.at(0).conditions;
  ASSERT_EQ(conditions.size(), 2u);
  EXPECT_EQ(conditions[0].free, 0);
  EXPECT_EQ(conditions[0].quantity, Condition::Quantity::stress);
  EXPECT_EQ(conditions[0].rate, 0);
  EXPECT_EQ(conditions[1].free, 1);
  EXPECT_EQ(conditions[1].rate, 0.01);
  EXPECT_EQ(path_to_json(path_from_json(Json(path_to_json(file.path)), "p.json", "", true)), path_to_json(file.path));
  EXPECT_NE(test_refusal(triaxial).find("t.json: segments[0]: its free leaves the strain to the law"),
            std::string::npos);

  const auto refused = [&](const std::string& free) {
    return path_refusal(
        R"({"initial": {"nu": 0.7}, "segments": [{"mode": "UNI", "extent": {"eps_dev": 0.1}, "free": )" + free + "}]}");
  };
  EXPECT_NE(refused(R"({"zz": {"quantity": "stress"}})").find("p.json: segments[0].free: zz is free and has a rate"),
            std::string::npos);
  EXPECT_NE(refused(R"({"volume": {"quantity": "stress"}})").find("segments[0].free: volume"), std::string::npos);
  EXPECT_NE(refused(R"({"xx": {"quantity": "force"}})").find("segments[0].free.xx.quantity: got \"force\""),
            std::string::npos);
  EXPECT_NE(refused(R"({"xz": {}})").find("segments[0].free.xz: misses the key 'quantity'"), std::string::npos);
}

TEST_F(PathFiles, MeasuredStrainsBecomeSegments) {
  const auto path = put("p.json", R"({"initial": {"nu": 0.7}, "strain_csv": "m.csv"})");
  // two collinear rows of UNI, a repeated row, and a shear; other columns do not matter
  put("m.csv",
      "time[s],strain_xx,strain_yy,strain_zz,strain_xz\n0,0.1,0,0,0\n1,0.1,0,-0.01,0\n2,0.1,0,-0.04,0\n3,0.1,0,-0.04,"
      "0\n"
      "4,0.1,0,-0.04,0.02\n");
  const auto segments = resolve(read_path(path).path);
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_NEAR(segments[1].strain_start.tensor(2, 2), -0.04, 1e-15);
  EXPECT_NEAR(segments[1].nu_start, 0.7 * std::exp(0.04), 1e-15);
  const Eigen::Matrix3d end = segments[1].strain(segments[1].length).tensor;
  EXPECT_NEAR(end(0, 2), 0.02, 1e-15);
  EXPECT_NEAR(end(0, 0), 0, 1e-15) << "counted from the first row";

  // Found by the fuzzer: a change of 5e-324 became an infinite direction; one of rounding was a turn.
  put("m.csv", "strain_xx,strain_yy,strain_zz\n0,0,0\n5e-324,0,0\n0,0.001,0\n1e-17,0.001,-2e-18\n0,0.002,0\n");
  const auto smooth = resolve(read_path(path).path);
  ASSERT_EQ(smooth.size(), 1u);
  EXPECT_NEAR(smooth[0].strain(smooth[0].length).tensor(1, 1), 0.002, 1e-15);

  const auto refused = [&](const std::string& csv) {
    put("m.csv", csv);
    return without_folder(refusal([&] { read_path(path); }));
  };
  EXPECT_NE(refused("strain_xx,strain_yy\n0,0\n").find("m.csv: header, column 'strain_zz': is missing"),
            std::string::npos);
  EXPECT_NE(refused("strain_xx,strain_yy,strain_zz\n0,0,0\n0,,0\n").find("m.csv: row 2, column 'strain_yy': is empty"),
            std::string::npos);
  EXPECT_NE(refused("strain_xx,strain_yy,strain_zz\n0,0,0\n0,0,x\n").find("m.csv: row 2, column 'strain_zz': 'x'"),
            std::string::npos);
  EXPECT_NE(
      refused("strain_xx,strain_yy,strain_zz\n0,0,0\n0,0,-1\n").find("m.csv: row 2, column 'strain_xx': the strain"),
      std::string::npos);
  EXPECT_NE(refused("strain_xx,strain_yy,strain_zz\n0,0,0\n0,0,0\n").find("the strain never changes"),
            std::string::npos);
  EXPECT_NE(path_refusal(R"({"initial": {"nu": 0.7}})").find("misses the key 'segments'"), std::string::npos);
  EXPECT_NE(path_refusal(R"({"initial": {"nu": 0.7}, "strain_csv": "m.csv", "segments": [
      {"mode": "D2", "extent": {"eps_dev": 0.1}}]})")
                .find("give one of them"),
            std::string::npos);
}

// Few digits make no turns, and what turns within a strain of 1e-4 is kept.
TEST_F(PathFiles, MeasuredStrainsAreStraightWithinTheirDigits) {
  const auto path = put("p.json", R"({"initial": {"nu": 0.7}, "strain_csv": "m.csv"})");
  std::string line = "strain_xx,strain_yy,strain_zz\n", cycles = line, circle = line;
  for (int i = 0; i <= 3000; ++i) line += fmt::format("{:.5f},{:.5f},{:.5f}\n", 1.3e-5 * i, 0.7e-5 * i, -3.1e-5 * i);
  const auto straight = resolve(read_path((put("m.csv", line), path)).path);
  ASSERT_EQ(straight.size(), 1u);
  EXPECT_NEAR(straight[0].strain(straight[0].length).tensor(2, 2), -0.093, 1e-15);

  for (int i = 0; i <= 60; ++i) cycles += fmt::format("0,0,{}\n", 2e-5 * std::abs((i % 20) - 10));
  const auto legs = resolve(read_path((put("m.csv", cycles), path)).path);
  ASSERT_EQ(legs.size(), 6u);
  for (const StraightSegment& leg : legs) EXPECT_NEAR(leg.length, 2e-4, 4.1e-5);

  for (int i = 0; i <= 2000; ++i)
    circle += fmt::format("{},0,{}\n", 0.01 * std::cos(0.001 * i) - 0.01, 0.01 * std::sin(0.001 * i));
  const PathFile smooth = read_path((put("m.csv", circle), path));
  EXPECT_TRUE(smooth.warnings.empty());
  EXPECT_LT(smooth.path.segments.size(), 40u);
  const auto chords = resolve(smooth.path);
  for (const StraightSegment& chord : chords) {
    const Eigen::Matrix3d middle = chord.strain(chord.length / 2).tensor;
    EXPECT_NEAR(std::hypot(middle(0, 0) + 0.01, middle(2, 2)), 0.01, 3e-5);
  }
}

TEST_F(PathFiles, NoiseOfMeasuredStrainsIsSaid) {
  const auto path = put("p.json", R"({"initial": {"nu": 0.7}, "strain_csv": "m.csv"})");
  const auto warnings = [&](double noise) {
    std::string rows = "strain_xx,strain_yy,strain_zz\n0,0,0\n";
    for (int i = 1; i <= 100; ++i)
      rows += fmt::format("{},0,{}\n", noise * std::sin(3.0 * i * i), -1e-3 * i + noise * std::cos(5.0 * i * i));
    return read_path((put("m.csv", rows), path)).warnings;
  };
  EXPECT_TRUE(warnings(2e-6).empty());
  ASSERT_EQ(warnings(3e-4).size(), 1u);
  EXPECT_NE(warnings(3e-4)[0].find("turns by more than 10 degrees"), std::string::npos) << warnings(3e-4)[0];
}

TEST_F(PathFiles, AreRefusedNamingTheSegment) {
  const auto segment = [&](const std::string& s) {
    return path_refusal(R"({"initial": {"nu": 0.7}, "segments": [)" + s + "]}");
  };
  EXPECT_NE(segment(R"({"mode": "D2"})").find("p.json: segments[0]: misses the key 'extent'"), std::string::npos);
  EXPECT_NE(segment(R"({"extent": {"eps_dev": 0.1}})").find("p.json: segments[0]: misses its direction"),
            std::string::npos);
  EXPECT_NE(segment(R"({"mode": "D2", "rate_tensor": [[1,0,0],[0,0,0],[0,0,-1]], "extent": {"eps_dev": 0.1}})")
                .find("has mode and rate_tensor"),
            std::string::npos);
  EXPECT_NE(segment(R"({"rate_tensor": [[1,1,0],[0,0,0],[0,0,-1]], "extent": {"eps_dev": 0.1}})")
                .find("segments[0].rate_tensor: is not symmetric"),
            std::string::npos);
  EXPECT_NE(segment(R"({"rate_tensor": [[0,0,0],[0,0,0],[0,0,0]], "extent": {"eps_dev": 0.1}})")
                .find("segments[0].rate_tensor: is zero"),
            std::string::npos);
  EXPECT_NE(
      segment(R"({"mode": "D2", "extent": {"eps_dev": 0.1, "eps_vol": 0.1}})").find("p.json: segments[0].extent: "),
      std::string::npos);
  EXPECT_NE(segment(R"({"mode": "D2", "extent": {"eps_vol": 0.1}})")
                .find("p.json: segments[0].extent: eps_vol cannot be reached"),
            std::string::npos);
  EXPECT_NE(segment(R"({"mode": "ISO", "extent": {"target_nu": 0.6}})")
                .find("p.json: segments[0].extent: target_nu 0.6 lies behind"),
            std::string::npos);
  EXPECT_NE(segment(R"({"mode": "ISO", "extent": {"eps_vol": 0.9}})").find("p.json: segments[0]: volume fraction"),
            std::string::npos);
  EXPECT_NE(segment(R"({"mode": "D2", "axes": "xxz", "extent": {"eps_dev": 0.1}})")
                .find("p.json: segments[0].axes: got \"xxz\""),
            std::string::npos);
  EXPECT_NE(path_refusal(R"({"initial": {"nu": 0.95}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]})")
                .find("p.json: initial.nu: got 0.95"),
            std::string::npos);
  EXPECT_NE(path_refusal(R"({"segments": []})").find("p.json: "), std::string::npos);
}

TEST_F(PathFiles, TestsStartWhereTheySay) {
  dem::TestFile test = dem::read_test(
      put("t.json", R"({"particles": 64, "seed": 9, "keep": [{"nu": 0.7}, {"nu": 0.75, "branch": "loading"}]})"));
  EXPECT_EQ(test.start, dem::Start::preparation);
  EXPECT_EQ(test.preparation.packing.seed, 9u);
  EXPECT_EQ(test.preparation.keep_unloading, std::vector<double>{0.7});
  EXPECT_EQ(test.preparation.keep_loading, std::vector<double>{0.75});

  test = dem::read_test(put(
      "t.json",
      R"({"initial": {"nu": 0.7, "branch": "loading"}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]})"));
  EXPECT_EQ(test.start, dem::Start::kept);
  EXPECT_EQ(test.preparation.keep_loading, std::vector<double>{0.7});
  EXPECT_EQ(test.path.nu, 0.7);

  // four spheres of radius 1 mm in a cube of 10 mm
  put("s.csv",
      "id,x,y,z,r,vx,vy,vz\n0,0.001,0.001,0.001,0.001,0,0,0\n1,0.005,0.001,0.001,0.001,0,0,0\n2,0.001,0.005,0.001,0."
      "001,0,0,0\n3,0.001,0.001,0.005,0.001,0,0,0\n");
  const std::string cell = R"("cell": [[0.01,0,0],[0,0.01,0],[0,0,0.01]])";
  const std::string uni = R"("segments": [{"mode": "UNI", "extent": {"eps_dev": 0.1}}])";
  test = dem::read_test(put("t.json", R"({"spheres": "s.csv", )" + cell + ", " + uni + "}"));
  EXPECT_EQ(test.start, dem::Start::spheres);
  ASSERT_TRUE(test.given);
  EXPECT_NEAR(test.path.nu, 4 * 4.0 / 3 * std::numbers::pi * 1e-9 / 1e-6, 1e-15);

  dem::write_state(folder_ / "a.state", *test.given);
  test = dem::read_test(put("t.json", R"({"state": "a.state", )" + uni + "}"));
  EXPECT_EQ(test.start, dem::Start::state);
  EXPECT_EQ(test.given->packing.size(), 4u);
  const std::string digest = test.given_digest;
  EXPECT_EQ(digest.size(), 64u);

  dem::State hertz = *test.given;
  hertz.contacts.normal_force = NormalForce::hertz;
  dem::write_state(folder_ / "a.state", hertz);
  EXPECT_NE(test_refusal(R"({"state": "a.state", )" + uni + "}").find("was made with other contacts"),
            std::string::npos);
  const std::string lammps = R"({"state": "a.state", "engine": "lammps", "normal_force": "hertz", )";
  EXPECT_EQ(dem::read_test(put("t.json", lammps + uni + "}")).given->contacts.normal_force, NormalForce::hertz);
  EXPECT_NE(test_refusal(lammps + R"("frames": 3, )" + uni + "}").find("frames: belongs to the engine 'grainlaw'"),
            std::string::npos);
}

// Steps are those of what is given: a metre is as good as a millimetre.
TEST_F(PathFiles, GivenSpheresAreJudgedByTheirOwnSize) {
  const auto work_of = [&](double size, double rate) {
    put("s.csv", fmt::format("id,x,y,z,r\n0,{0},{0},{0},{0}\n1,{1},{0},{0},{0}\n", size, 5 * size));
    const std::string box = fmt::format(R"("cell": [[{0},0,0],[0,{0},0],[0,0,{0}]])", 10 * size);
    return expected_work(dem::read_test(
        put("t.json", fmt::format(R"({{"spheres": "s.csv", {}, "strain_rate": {}, "contact_viscosity": 0, "segments": [
            {{"mode": "UNI", "extent": {{"eps_dev": 0.1}}}}]}})",
                                  box, rate))));
  };
  // a collision takes as long as the root of the mass
  EXPECT_NEAR(work_of(1, 100 / std::pow(1e3, 1.5)) / work_of(1e-3, 100), 1, 1e-3);
}

TEST_F(PathFiles, LoosePreparationsEndWhereTheyBegin) {
  EXPECT_EQ(dem::read_test(put("t.json", R"({"nu_start": 0.6, "nu_max": 0.65})")).preparation.nu_end, 0.6);
}

// What a packing that is given is made of stands in what gives it; a key that nobody reads must not look as if it were.
TEST_F(PathFiles, KeysThatAGivenPackingDoesNotReadAreRefused) {
  put("s.csv", "id,x,y,z,r\n0,0.001,0.001,0.001,0.001\n1,0.005,0.001,0.001,0.001\n");
  const std::string cell = R"("cell": [[0.01,0,0],[0,0.01,0],[0,0,0.01]])";
  const auto spheres = dem::read_test(put("t.json", R"({"spheres": "s.csv", "stiffness": 2e8, )" + cell + "}"));
  EXPECT_EQ(spheres.given->material.stiffness, 2e8);
  dem::write_state(folder_ / "a.state", *spheres.given);
  for (const char* key : {"density", "stiffness", "contact_viscosity", "background_viscosity"}) {
    const std::string message = test_refusal(fmt::format(R"({{"state": "a.state", "{}": 3}})", key));
    EXPECT_NE(message.find(fmt::format("t.json: {}: is not read, the state has its own; remove it, or give", key)),
              std::string::npos)
        << message;
  }
  for (const char* key : {"particles", "mean_radius", "size_width", "seed"}) {
    for (const std::string& given : {std::string(R"("state": "a.state")"), R"("spheres": "s.csv", )" + cell}) {
      const std::string message = test_refusal(fmt::format(R"({{{}, "{}": 3}})", given, key));
      EXPECT_NE(message.find(fmt::format("t.json: {}: belongs to a packing that is made", key)), std::string::npos)
          << message;
    }
  }
  EXPECT_NE(test_refusal(R"({"state": "a.state", "nu_max": 0.8})").find("t.json: nu_max: belongs to"),
            std::string::npos);
}

// numpy writes the -0.0 that it computes.
TEST_F(PathFiles, NegativeZeroOfATensorIsZero) {
  const PathFile read = read_path(put("p.json", R"({"initial": {"nu": 0.7}, "segments": [{"rate_tensor":
      [[-0.0, 0.0, -0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, -1.0]], "extent": {"eps_dev": 0.1}},
      {"velocity_gradient": [[-0, 0, 0], [0, 1, -0.0], [0, 0, -1]], "extent": {"eps_dev": 0.1}}]})"));
  for (const PathSegment& segment : read.path.segments) {
    EXPECT_EQ(segment.direction.tensor, direction_of(Mode::D2, "yxz", false).tensor);
    for (const double component : segment.direction.tensor.reshaped())
      EXPECT_FALSE(component == 0 && std::signbit(component));
  }
}

TEST_F(PathFiles, TestsThatContradictThemselvesAreRefused) {
  const std::string uni = R"("segments": [{"mode": "UNI", "extent": {"eps_dev": 0.1}}])";
  EXPECT_NE(test_refusal("{" + uni + "}").find("t.json: segments: start nowhere"), std::string::npos);
  EXPECT_NE(test_refusal(R"({"initial": {"nu": 0.7}, "state": "x", )" + uni + "}").find("exclude each other"),
            std::string::npos);
  EXPECT_NE(test_refusal(R"({"initial": {"nu": 0.7}})").find("misses the key 'segments'"), std::string::npos);
  EXPECT_NE(test_refusal(R"({"spheres": "s.csv", )" + uni + "}").find("misses the key 'cell'"), std::string::npos);
  EXPECT_NE(test_refusal(R"({"state": "none.state", )" + uni + "}").find("none.state"), std::string::npos);
  EXPECT_NE(test_refusal(R"({"initial": {"nu": 0.7}, "keep": [{"nu": 0.7}], )" + uni + "}").find("t.json: keep: "),
            std::string::npos);
  EXPECT_NE(test_refusal(R"({"initial": {"nu": 0.83}, )" + uni + "}").find("0.83 is not on the unloading branch"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::app
