// PATH and TEST files.
#include <cmath>
#include <numbers>
#include "app/files/path_file.hpp"
#include "app/files/path_json.hpp"
#include "app/files/spec_file.hpp"
#include "app/files/test_file.hpp"
#include "app/new_packings.hpp"
#include "dem/state_file.hpp"

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
    return without_folder(refusal([&] { read_test(file); }));
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
  const Spec spec = read_spec(quickstart / "spec.json");
  EXPECT_GE(spec.densities.size(), 5u);
  for (const char* name : {"uniaxial-0.695.json", "uniaxial-0.728.json"}) {
    const PathFile path = read_path(quickstart / name);
    // its packings are shared by the predictions and are none of the calibration's
    EXPECT_EQ(plan(spec, path, new_seeds(spec, path, {}, name), name).front().preparation.keep_unloading, spec.keep);
  }
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
  TestFile test = read_test(
      put("t.json", R"({"particles": 64, "seed": 9, "keep": [{"nu": 0.7}, {"nu": 0.75, "branch": "loading"}]})"));
  EXPECT_EQ(test.start, Start::preparation);
  EXPECT_EQ(test.preparation.packing.seed, 9u);
  EXPECT_EQ(test.preparation.keep_unloading, std::vector<double>{0.7});
  EXPECT_EQ(test.preparation.keep_loading, std::vector<double>{0.75});

  test = read_test(put(
      "t.json",
      R"({"initial": {"nu": 0.7, "branch": "loading"}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]})"));
  EXPECT_EQ(test.start, Start::kept);
  EXPECT_EQ(test.preparation.keep_loading, std::vector<double>{0.7});
  EXPECT_EQ(test.path.nu, 0.7);

  // four spheres of radius 1 mm in a cube of 10 mm
  put("s.csv",
      "id,x,y,z,r,vx,vy,vz\n0,0.001,0.001,0.001,0.001,0,0,0\n1,0.005,0.001,0.001,0.001,0,0,0\n2,0.001,0.005,0.001,0."
      "001,0,0,0\n3,0.001,0.001,0.005,0.001,0,0,0\n");
  const std::string cell = R"("cell": [[0.01,0,0],[0,0.01,0],[0,0,0.01]])";
  const std::string uni = R"("segments": [{"mode": "UNI", "extent": {"eps_dev": 0.1}}])";
  test = read_test(put("t.json", R"({"spheres": "s.csv", )" + cell + ", " + uni + "}"));
  EXPECT_EQ(test.start, Start::spheres);
  ASSERT_TRUE(test.given);
  EXPECT_NEAR(test.path.nu, 4 * 4.0 / 3 * std::numbers::pi * 1e-9 / 1e-6, 1e-15);

  dem::write_state(folder_ / "a.state", *test.given);
  test = read_test(put("t.json", R"({"state": "a.state", )" + uni + "}"));
  EXPECT_EQ(test.start, Start::state);
  EXPECT_EQ(test.given->packing.size(), 4u);
  const std::string digest = test.given_digest;
  EXPECT_EQ(digest.size(), 64u);
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
