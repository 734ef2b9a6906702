#include "dem/runs/spec_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "dem/runs/feasibility.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

using testing::refusal;

dem::Spec spec(const std::string& text) {
  return spec_from_json(parse_json(text, "s.json", JsonSource::user), "s.json");
}
std::string spec_refusal(const std::string& text) {
  return refusal([&] { spec(text); });
}

TEST(SpecFile, FillsInTheDocumentedDefaults) {
  const Spec s = spec("{}");
  EXPECT_EQ(s.seeds, (std::vector<std::uint64_t>{1, 2}));
  ASSERT_EQ(s.tests.size(), 3u);
  EXPECT_EQ(s.tests[0].mode, "ISO");
  EXPECT_EQ(s.tests[1].mode, "D2");
  EXPECT_EQ(s.tests[2].mode, "D2-ISO");
  for (const TestRequest& test : s.tests) EXPECT_EQ(test.role, Role::calibration);
  EXPECT_EQ(s.tests[1].densities, s.densities);
  EXPECT_EQ(s.preparation.keep_unloading, s.densities);
  EXPECT_TRUE(s.preparation.keep_loading.empty());
}

TEST(SpecFile, TestsMayAskForProbes) {
  const Spec s = spec(R"({"tests": [{"mode": "D2", "role": "calibration", "probes": {"every": 0.05}},
    {"mode": "D3", "role": "validation", "probes": {"every": 0.1, "step": [1e-7, 1e-5]}}, {"mode": "UNI", "role": "validation"}]})");
  EXPECT_EQ(s.tests[0].probes->every, 0.05);
  EXPECT_EQ(s.tests[0].probes->steps, std::vector<double>{1e-6});
  EXPECT_EQ(s.tests[1].probes->steps, (std::vector<double>{1e-7, 1e-5}));
  EXPECT_FALSE(s.tests[2].probes);
  EXPECT_EQ(spec_to_json(spec(spec_to_json(s).dump())), spec_to_json(s));
  EXPECT_FALSE(spec_to_json(s)["tests"][2].contains("probes"));

  const auto probes = [](const std::string& object) {
    return spec_refusal(R"({"tests": [{"mode": "D2", "role": "calibration", "probes": )" + object + "}]}");
  };
  EXPECT_NE(probes("{}").find("tests[0].probes"), std::string::npos);
  EXPECT_NE(probes(R"({"every": 0})").find("tests[0].probes.every"), std::string::npos);
  EXPECT_NE(probes(R"({"every": 0.1, "step": 0.5})").find("tests[0].probes.step"), std::string::npos);
  EXPECT_NE(probes(R"({"every": 0.1, "step": []})").find("tests[0].probes.step"), std::string::npos);
  EXPECT_NE(spec_refusal(R"({"tests": [{"mode": "ISO", "role": "calibration", "probes": {"every": 0.05}}]})")
                .find("tests[0].probes: ISO is the preparation's own branch"),
            std::string::npos);
}

TEST(SpecFile, ReadsEveryKey) {
  const Spec s = spec(
      R"({"particles": 64, "seeds": [5], "size_width": 2, "mean_radius": 2e-3, "density": 1000, "stiffness": 1e7, "contact_viscosity": 0.5,
    "background_viscosity": 0.2, "time_step_fraction": 0.05, "skin": 0.2, "strain_rate": 50, "driving": "constant", "transport": "wall", "rows": 50,
    "nu_start": 0.65, "nu_max": 0.81, "nu_end": 0.66, "densities": [0.75, 0.7], "keep": [0.72], "coupling": "single", "tests": [{"mode": "D3", "role": "validation"}]})");
  const PreparationOptions& p = s.preparation;
  EXPECT_EQ(p.packing.particles, 64);
  EXPECT_EQ(p.packing.size_width, 2);
  EXPECT_EQ(p.packing.mean_radius, 2e-3);
  EXPECT_EQ(p.packing.material.density, 1000);
  EXPECT_EQ(p.packing.material.stiffness, 1e7);
  EXPECT_EQ(p.packing.material.contact_viscosity, 0.5);
  EXPECT_EQ(p.packing.material.background_viscosity, 0.2);
  EXPECT_EQ(p.engine.time_step_fraction, 0.05);
  EXPECT_EQ(p.engine.skin, 0.2);
  EXPECT_EQ(p.drive.strain_rate, 50);
  EXPECT_EQ(spec(R"({"quasi_static_step": 0.002})").preparation.drive.quasi_static_step, 0.002);
  EXPECT_EQ(p.drive.profile, Profile::constant);
  EXPECT_EQ(p.drive.transport, Transport::wall);
  EXPECT_EQ(p.rows, 50);
  EXPECT_EQ(p.nu_start, 0.65);
  EXPECT_EQ(p.nu_max, 0.81);
  EXPECT_EQ(p.nu_end, 0.66);
  EXPECT_EQ(s.seeds, std::vector<std::uint64_t>{5});
  EXPECT_EQ(s.densities, (std::vector<double>{0.7, 0.75}));
  EXPECT_EQ(s.coupling, "single");
  EXPECT_EQ(p.keep_unloading, (std::vector<double>{0.7, 0.72, 0.75}));
  EXPECT_EQ(s.tests[0].role, Role::validation);
}

TEST(SpecFile, ResolvedFormReadsBackTheSame) {
  for (
      const char* text :
      {"{}",
       R"({"densities": [0.71], "tests": [{"mode": "ISO", "branch": "loading", "role": "validation"}, {"mode": "UNI", "density": [0.7, 0.695], "role": "validation"},
        {"segments": [{"mode": "D2", "axes": "yzx", "reverse": true, "extent": {"eps_dev": 0.1}}, {"rate_tensor": [[1,0,0],[0,1,0],[0,0,-2]], "extent": {"eps_dev": 0.2}}],
         "density": 0.7, "branch": "loading", "role": "calibration"}, {"mode": "ISO", "role": "calibration"}]})"}) {
    const Spec first = spec(text);
    const std::string resolved = json_text(spec_to_json(first));
    const Spec second = spec_from_json(parse_json(resolved, "r.json", JsonSource::own), "r.json");
    EXPECT_EQ(json_text(spec_to_json(second)), resolved);
    EXPECT_EQ(spec_to_json(second), spec_to_json(spec(resolved)));
  }
}

TEST(SpecFile, TestsBecomePathsAndNames) {
  const Spec s = spec("{}");
  const auto path = [&](const char* mode, double strain) {
    TestRequest test;
    test.mode = mode;
    test.strain = strain;
    return path_of(test, 0.7, s);
  };
  // equations.md 0: D2-ISO shears to 0.15, then goes to nu + 0.03 and back
  const auto d2_iso = resolve(path("D2-ISO", s.tests[2].strain));
  ASSERT_EQ(d2_iso.size(), 3u);
  EXPECT_NEAR(d2_iso[0].eps_dev_rate() * d2_iso[0].length, 0.15, 1e-15);
  EXPECT_NEAR(d2_iso[1].nu(d2_iso[1].length), 0.73, 1e-15);
  EXPECT_NEAR(d2_iso[2].nu(d2_iso[2].length), 0.70, 1e-15);
  EXPECT_NEAR(resolve(path("UNI", 0))[0].nu(resolve(path("UNI", 0))[0].length), s.preparation.nu_max, 1e-15);
  EXPECT_NEAR(resolve(path("UNI", 0.1))[0].eps_dev_rate() * resolve(path("UNI", 0.1))[0].length, 0.1, 1e-15);
  EXPECT_EQ(path("D3", 0.2).segments[0].mode, Mode::D3);

  EXPECT_EQ(record_name(s.tests[0], 0, 7), "ISO-unloading-s7");
  EXPECT_EQ(record_name(s.tests[1], 0.7, 7), "D2-0.70-s7");
  EXPECT_EQ(density_text(0.695), "0.695");
  EXPECT_EQ(density_text(0.8), "0.80");
}

TEST(SpecFile, RefusesWhatNoSchemaCanSay) {
  EXPECT_EQ(spec_refusal(R"({"densities": [0.85]})"),
            "s.json: densities or keep: 0.85 is not on the unloading branch [nu_end, nu_max] = [0.66, 0.82]");
  EXPECT_EQ(spec_refusal(R"({"nu_start": 0.7, "nu_max": 0.69})"), "s.json: nu_max: 0.69 must lie above nu_start = 0.7");
  EXPECT_NE(spec_refusal(R"({"nu_end": 0.63})").find("s.json: nu_end: "), std::string::npos);
  EXPECT_NE(spec_refusal(R"({"contact_viscosity": 1e6})").find("s.json: contact_viscosity: "), std::string::npos);
  EXPECT_NE(spec_refusal(R"({"strain_rate": 1e-6})").find("s.json: strain_rate: "),
            std::string::npos);  // S2: steps without end
  EXPECT_NE(spec_refusal(R"({"engine": "lammps", "tests": [{"mode": "D2", "role": "calibration", "probes": {"every": 0.05}}]})")
                .find("s.json: tests[0]: probes: belongs to the engine 'grainlaw'"),
            std::string::npos);
  EXPECT_NE(spec_refusal(R"({"tests": [{"role": "calibration"}]})").find("s.json: tests[0]: misses what to do"),
            std::string::npos);
  EXPECT_NE(spec_refusal(R"({"tests": [{"mode": "ISO", "density": 0.7, "role": "calibration"}]})")
                .find("s.json: tests[0].density: "),
            std::string::npos);
  EXPECT_NE(
      spec_refusal(
          R"({"tests": [{"mode": "D2", "role": "calibration"}, {"mode": "D2", "density": 0.7, "role": "validation"}]})")
          .find("s.json: tests[1].name: 'D2'"),
      std::string::npos);
  EXPECT_NE(
      spec_refusal(
          R"({"tests": [{"segments": [{"mode": "ISO", "extent": {"eps_dev": 1}}], "density": 0.7, "role": "calibration"}]})")
          .find("s.json: tests[0]: at nu = 0.7: segments[0].extent"),
      std::string::npos);
  EXPECT_NE(
      spec_refusal(R"({"tests": [{"segments": [{"extent": {"eps_dev": 1}}], "density": 0.7, "role": "calibration"}]})")
          .find("s.json: tests[0].segments[0]: misses its direction"),
      std::string::npos);
  EXPECT_NE(
      spec_refusal(
          R"({"tests": [{"segments": [{"rate_tensor": [[1,0.5,0],[0.5,-1,0],[0,0,0]], "extent": {"eps_dev": 1}}], "density": 0.7, "role": "calibration"}]})")
          .find("s.json: tests[0]"),
      std::string::npos);  // the engine deforms along the axes only
}

// What was fitted cannot judge the law: the same path from the same density is the same run.
TEST(SpecFile, RefusesToFitAndToJudgeByOneRun) {
  const auto said = [](const char* first, const char* second, const char* nu) {
    return spec_refusal(fmt::format(
        R"({{"tests": [{{"mode": "D2", "density": [0.7, 0.75], "role": "{}"}}, {{"name": "again", "mode": "D2", "density": {}, "role": "{}"}}]}})",
        first, nu, second));
  };
  EXPECT_EQ(said("calibration", "validation", "0.75"),
            "s.json: tests[1]: 'again-0.75-s1' (validation) is the run of tests[0] (calibration) on the same packings; "
            "what is fitted is fitted once and judges nothing, remove one or give it another path");
  for (const auto& [first, second] : {std::pair{"calibration", "rehearsal"},
                                      {"rehearsal", "calibration"},
                                      {"validation", "calibration"},
                                      {"calibration", "calibration"}})
    EXPECT_TRUE(said(first, second, "0.7").starts_with("s.json: tests[1]: 'again-0.70-s1'")) << first << ' ' << second;
  EXPECT_EQ(said("calibration", "validation", "0.72"), "accepted");
  EXPECT_EQ(said("calibration", "description", "0.7"), "accepted") << "by laws of its own";
  EXPECT_EQ(said("validation", "rehearsal", "0.7"), "accepted") << "neither is fitted";
  EXPECT_NE(spec_refusal(R"({"tests": [{"name": "once", "segments": [{"mode": "D2", "extent": {"eps_dev": 0.2}}], "density": 0.7, "role": "calibration"},
      {"name": "again", "segments": [{"rate_tensor": [[2,0,0],[0,0,0],[0,0,-2]], "extent": {"target_eps_dev": 0.2}}],
       "density": 0.7, "role": "rehearsal"}]})")
                .find("what is fitted is fitted once"),
            std::string::npos)
      << "however it is written";
}

TEST(SpecFile, StepsOfAPreparationFollowFromRatesAndTheShortestCollision) {
  Spec s = spec(
      R"({"driving": "constant", "strain_rate": 100, "nu_start": 0.64, "nu_max": 0.8, "nu_end": 0.7, "densities": [0.75]})");
  const Material& m = s.preparation.packing.material;
  // constant rate: eps_vol/rate for each branch, the gas compression gas_compression_factor times faster
  const double dt = 0.1 * collision_time(m, sphere_mass(m, 0.5e-3) / 2);
  const double seconds = (std::log(0.64 / 0.3) / 10 + std::log(0.8 / 0.64) + std::log(0.8 / 0.7)) / 100;
  EXPECT_NEAR(expected_steps(s.preparation), seconds / dt, 3);
}

}  // namespace
}  // namespace grainlaw::dem
