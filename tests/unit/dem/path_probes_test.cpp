// Probes along a test: they do not change it, survive its interruptions, and are where they are asked for.
#include "dem/runs/path_probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem/files/state_file.hpp"
#include "dem/runs/run_store.hpp"
#include "dem/runs/runs.hpp"
#include "model/files/csv_table.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

class PathProbesTest : public testing::TemporaryFolder {
 protected:
  PathProbesTest() : store_(folder_, "runs") {
    scene::Draw draw(3);
    setup_.given = scene::random_state(60, 3, 0.74, scene::cubic(1), draw);
    setup_.given_digest = "of the scene";
    setup_.relax = true;
    setup_.rows = 10;
    setup_.preparation.drive.strain_rate = 5000;
  }

  static Path shear_then_compress() {
    return {0.74,
            Branch::unloading,
            {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.03},
             {Mode::ISO, direction_of(Mode::ISO), ExtentKind::eps_vol, 0.015}}};
  }

  fs::path run(TestSetup test, const Path& path, const ResumePolicy& policy = {}, const RunControl& control = {}) {
    test.path = path;
    return store_.folder(ensure_test(store_, test, policy, control).at("key"));
  }

  TestSetup probed(ProbeRequest probes = {0.01, {1e-6}}) const {
    TestSetup test = setup_;
    test.probes = std::move(probes);
    return test;
  }

  /// Values of a column.
  static std::vector<double> column(const fs::path& run, const std::string& title) {
    CsvReader reader(run / "probes.csv");
    const auto at = std::find(reader.header().begin(), reader.header().end(), title) - reader.header().begin();
    std::vector<double> values, row;
    while (reader.next(row)) values.push_back(row.at(static_cast<std::size_t>(at)));
    return values;
  }

  RunStore store_;
  TestSetup setup_;
};

TEST_F(PathProbesTest, DoNotDisturbTheRun) {
  scene::Draw draw(3);
  setup_.given = scene::random_state(700, 3, 0.74, scene::cubic(1), draw);  // wide enough for the vector engine
  setup_.given_digest = "of the wide scene";
  const Path path{0.74, Branch::unloading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 0.004}}};
  for (const Precision precision : {Precision::mixed, Precision::full, Precision::reference}) {
    setup_.preparation.engine.precision = precision;
    const fs::path without = run(setup_, path), with = run(probed({0.002, {1e-6}}), path);
    EXPECT_NE(without, with);
    EXPECT_FALSE(fs::exists(without / "probes.csv"));
    EXPECT_EQ(column(with, "B_star").size(), 3u);
    EXPECT_EQ(content(without / "series.csv"), content(with / "series.csv"));
    State a = read_state(without / "end.state"), b = read_state(with / "end.state");
    a.digest = b.digest;
    write_state(folder_ / "a", a);
    write_state(folder_ / "b", b);
    EXPECT_EQ(content(folder_ / "a"), content(folder_ / "b"));
  }
}

TEST_F(PathProbesTest, AreWhereThePathHasGrown) {
  const fs::path folder = run(probed({0.01, {1e-7, 1e-6}}), shear_then_compress());
  const auto shear = column(folder, "shear_path"), vol = column(folder, "eps_vol"), step = column(folder, "step");
  // 0, .01, .02, .03 along the shear, .04 at a volume strain of .01; two rows each
  ASSERT_EQ(shear.size(), 10u);
  const double step_strain = 1e-3;  // beyond a place by one time step at most
  for (std::size_t row = 0; row < 10; ++row) {
    const double place = 0.01 * static_cast<double>(row / 2), sheared = std::min(place, 0.03);
    EXPECT_GE(shear[row], sheared - 1e-9);
    EXPECT_LE(shear[row], sheared + step_strain);
    EXPECT_LE(vol[row], -(place - sheared) + 1e-9);
    EXPECT_GE(vol[row], -(place - sheared) - step_strain);
    EXPECT_EQ(step[row], row % 2 == 0 ? 1e-7 : 1e-6);
  }
  for (const double relaxed : column(folder, "relaxed")) EXPECT_EQ(relaxed, 1);
  const auto A1 = column(folder, "A1_star"), A2 = column(folder, "A2_star"), P = column(folder, "P_star"),
             s = column(folder, "s_par"), B = column(folder, "B_star");
  for (std::size_t row = 0; row < 10; ++row) {
    EXPECT_NEAR(A1[row], 2.0 / 3 * (A2[row] - s[row] * P[row]), 1e-6 * B[row]);
  }
}

TEST_F(PathProbesTest, SurviveInterruptions) {
  TestSetup test = probed();
  test.path = shear_then_compress();
  const std::string expected = content(run(test, shear_then_compress()) / "probes.csv");
  const fs::path folder = store_.folder(test_key(test));
  const auto interrupted_after = [&](int probes) {
    fs::remove(folder / "run.json");
    for (int reports = 0; !fs::exists(folder / kProgress) ||
                          content(folder / kProgress).find(fmt::format("\"places\": {}", probes)) == std::string::npos;
         ++reports) {
      std::stop_source stop;
      int seen = 0;
      const RunControl control{[&](const Progress&) {
                                 if (++seen > reports) stop.request_stop();
                               },
                               stop.get_token()};
      ASSERT_LT(reports, 1000);
      ASSERT_THROW(run(test, shear_then_compress(), {true, 0, {}}, control), Interrupted);
    }
  };
  interrupted_after(1);
  EXPECT_EQ(content(run(test, shear_then_compress()) / "probes.csv"), expected);

  interrupted_after(1);
  std::string damaged = content(folder / kProgress);
  damaged[damaged.find("rows") + 40] ^= 1;
  std::ofstream(folder / kProgress, std::ios::binary) << damaged;
  std::vector<std::string> log;
  run(test, shear_then_compress(), {true, 60, [&](const std::string& text) { log.push_back(text); }});
  EXPECT_EQ(content(folder / "probes.csv"), expected);
  EXPECT_NE(log.back().find("what was probed before the checkpoint is damaged"), std::string::npos);
}

TEST_F(PathProbesTest, WithoutShearAndWithoutSegments) {
  Path compress = shear_then_compress();
  compress.segments.erase(compress.segments.begin());
  for (const Path& path : {compress, Path{0.74, Branch::unloading, {}}}) {
    const fs::path folder = run(probed(), path);
    ASSERT_EQ(column(folder, "B_star").size(), path.segments.empty() ? 1u : 2u);
    EXPECT_GT(column(folder, "B_star")[0], column(folder, "DG_star")[0]);
    EXPECT_TRUE(std::isnan(column(folder, "s_par")[0]));
    EXPECT_FALSE(std::isnan(column(folder, "s_dev")[0]));
  }
}

TEST_F(PathProbesTest, WithoutLoadMakeEmptyFields) {
  scene::Draw draw(3);
  setup_.given = scene::random_state(20, 3, 0.2, scene::cubic(1), draw);
  setup_.given_digest = "loose";
  const fs::path folder = run(probed(), {0.2, Branch::unloading, {}});
  EXPECT_TRUE(std::isnan(column(folder, "B_star").at(0)));
  EXPECT_TRUE(std::isnan(column(folder, "step").at(0)));
  EXPECT_EQ(column(folder, "spheres").at(0), 0);
}

}  // namespace
}  // namespace grainlaw::dem
