#include "predict/rehearse.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "predict/predict.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::predict {
namespace {

using testing::leg;

/// The published law; an error of 1 % of its pressure's prefactor, runs that scatter.
CalibratedLaw law_with_errors() {
  CalibratedLaw law;
  law.parameters = published_parameters();
  law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  const auto p0 = static_cast<Eigen::Index>(parameter_index("pressure.p0"));
  law.covariance(p0, p0) = std::pow(0.01 * law.parameters.isotropic.pressure.p0, 2);
  law.estimates[static_cast<std::size_t>(p0)].degrees_of_freedom = 4;
  law.scatter = {3, 22, 1e-3, 0.02, 0.01};
  law.range = {};
  return law;
}

/// `offsets.size()` runs of D2 at nu = .74, each the reduced law plus its offset in units of w.
RehearsalRuns runs_off_by(const CalibratedLaw& law, const std::vector<double>& offsets) {
  RehearsalRuns runs{"off", {}, false};
  const Path path{0.74, Branch::unloading, {leg(Mode::D2, 0.2)}};
  const auto segments = resolve(path);
  const Prediction curve = predict(Rung::reduced, law.parameters, law.coupling, segments,
                                   state_from_law(law.parameters, path.nu), uniform_points(segments, 40), {}, {}, {});
  const ErrorUnits w = error_units(law.parameters, path.nu);
  for (const double offset : offsets) {
    TestRecord& run = runs.runs.emplace_back();
    run.name = "off-s" + std::to_string(runs.runs.size());
    run.path = path;
    for (const PredictedRow& row : curve.rows) {
      Observation& o = run.rows.emplace_back();
      o.time = row.shear_path;
      o.strain = row.strain;
      o.nu = row.nu;
      o.shear_path = row.shear_path;
      o.P_star = row.state.P + offset * w.B;
      o.s_par = row.s_par + offset * w.s_max;
      o.F_par = row.F_par + offset * w.F_max;
    }
  }
  return runs;
}

TEST(Rehearse, MeansTheRunsAndCountsWhatIsKnown) {
  const CalibratedLaw law = law_with_errors();
  std::vector<std::string> failures;
  const Rehearsal r = rehearsal_of(law, {Rung::reduced}, runs_off_by(law, {0.01, 0.03}), {}, failures);
  EXPECT_TRUE(failures.empty());
  EXPECT_EQ(r.packings, 2);
  EXPECT_EQ(r.kind, PathKind::monotone);
  ASSERT_EQ(r.rungs.size(), 1u);
  const ErrorUnits w = error_units(law.parameters, 0.74);
  for (const Rehearsed quantity : kValues<Rehearsed>) {
    const RehearsedQuantity& q = r.rungs[0].of(quantity);
    EXPECT_EQ(q.rows, 39) << "from shear_path .01 on, every .005";
    EXPECT_NEAR(q.square, 0.0004, 1e-12);
    EXPECT_NEAR(q.largest, 0.02, 1e-12);
  }
  // P: 1 % of P* from the prefactor, and 1e-3 B* between two runs; s: their scatter alone
  const double P = law.parameters.isotropic.P_star(0.74);
  EXPECT_NEAR(r.rungs[0].P_star.known, std::pow(0.01 * P / w.B, 2) + 1e-6 / 2, 1e-12);
  EXPECT_NEAR(r.rungs[0].s_par.known, std::pow(0.02 / w.s_max, 2) / 2, 1e-12);
  EXPECT_NEAR(r.rungs[0].F_par.known, std::pow(0.01 / w.F_max, 2) / 2, 1e-12);
}

TEST(Rehearse, TakesNothingOffOnPackingsThatWereFitted) {
  const CalibratedLaw law = law_with_errors();
  RehearsalRuns runs = runs_off_by(law, {0.01, 0.03});
  runs.fitted_packings = true;
  std::vector<std::string> failures;
  EXPECT_EQ(rehearsal_of(law, {Rung::reduced}, runs, {}, failures).rungs[0].P_star.known, 0);
}

TEST(Rehearse, LeavesOutARungThatFails) {
  CalibratedLaw law = law_with_errors();
  const RehearsalRuns runs = runs_off_by(law, {0.01});
  law.parameters.anisotropy.a2 = std::nan("");
  std::vector<std::string> failures;
  const Rehearsal r = rehearsal_of(law, {Rung::reduced, Rung::evolution}, runs, {}, failures);
  ASSERT_EQ(r.rungs.size(), 1u);
  EXPECT_EQ(r.rungs[0].rung, Rung::reduced);
  ASSERT_EQ(failures.size(), 1u);
  EXPECT_TRUE(failures[0].starts_with("rehearsal off: evolution is left out: ")) << failures[0];
}

TEST(Rehearse, RefusesRunsOfSeveralPaths) {
  const CalibratedLaw law = law_with_errors();
  RehearsalRuns runs = runs_off_by(law, {0.01, 0.03});
  runs.runs[1].rows.pop_back();
  std::vector<std::string> failures;
  const std::string said = testing::refusal([&] { rehearsal_of(law, {Rung::reduced}, runs, {}, failures); });
  EXPECT_NE(said.find("off-s1 and off-s2 have no rows at the same strains"), std::string::npos) << said;
  runs.runs.clear();
  EXPECT_NE(testing::refusal([&] { rehearsal_of(law, {Rung::reduced}, runs, {}, failures); }).find("has no run"),
            std::string::npos);
}

TEST(Rehearse, RowsCountWhereTheLawUnjamsBeforeTheRuns) {
  const CalibratedLaw law = law_with_errors();
  const Path path{0.68, Branch::unloading, {testing::leg_to(Mode::UNI, 0.65, true)}};
  const auto segments = resolve(path);
  const Prediction curve = predict(Rung::reduced, law.parameters, law.coupling, segments,
                                   state_from_law(law.parameters, path.nu), uniform_points(segments, 40), {}, {}, {});
  ASSERT_TRUE(curve.unjammed);
  RehearsalRuns runs{"unjams", {{}}, false};
  runs.runs[0].name = "unjams-s1";
  runs.runs[0].path = path;
  int counted = 0;
  for (const PredictedRow& row : curve.rows) {
    Observation& o = runs.runs[0].rows.emplace_back();
    o.time = row.shear_path;
    o.strain = row.strain;
    o.nu = row.nu;
    o.shear_path = row.shear_path;
    o.P_star = row.state.P + 0.01 * error_units(law.parameters, row.nu).B;  // carries on where the law has nothing left
    o.s_par = o.F_par = 0.1;
    counted += row.shear_path >= 0.01;
  }
  std::vector<std::string> failures;
  const RehearsedQuantity P = rehearsal_of(law, {Rung::reduced}, runs, {}, failures).rungs.at(0).P_star;
  EXPECT_EQ(P.rows, counted) << "the rung that unjams first is not judged by fewer rows";
  EXPECT_NEAR(P.square, 1e-4, 1e-10);
}

}  // namespace
}  // namespace grainlaw::predict
