#include "fit/stages/density_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/fit_stages.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

/// `seeds` series on the laws of `truth`, C* off by +-`scatter` in turn.
std::vector<DensitySeries> exact_series(const LawParameters<double>& truth, const std::vector<double>& densities,
                                        int seeds, double scatter = 0) {
  std::vector<DensitySeries> all;
  const StateLaw<double>& law = truth.isotropic;
  for (int seed = 0; seed < seeds; ++seed) {
    DensitySeries series{"iso-" + std::to_string(seed), seed, 0, {}};
    for (const double nu : densities) {
      const double phi = law.rattlers.fraction(nu, law.coordination.nu_c);
      series.points.push_back({nu, law.coordination.C_star(nu) * (1 + (seed % 2 == 0 ? scatter : -scatter)), phi,
                               law.P_star(nu), truth.fabric_g3 * nu * law.C(nu),
                               truth.overlap_D * std::log(nu / law.pressure.nu_c)});
    }
    all.push_back(series);
  }
  return all;
}

const std::vector<double> kDensities{0.68, 0.70, 0.72, 0.75, 0.78, 0.82};

void expect_recovered(const StateLaw<double>& found, const StateLaw<double>& truth, double tolerance) {
  const auto near = [&](double a, double b) { EXPECT_NEAR(a, b, tolerance * std::abs(b)); };
  near(found.coordination.C1, truth.coordination.C1);
  near(found.coordination.alpha, truth.coordination.alpha);
  near(found.coordination.nu_c, truth.coordination.nu_c);
  near(found.rattlers.phi_c, truth.rattlers.phi_c);
  near(found.rattlers.phi_v, truth.rattlers.phi_v);
  near(found.pressure.p0, truth.pressure.p0);
  near(found.pressure.gamma_p, truth.pressure.gamma_p);
  near(found.pressure.nu_c, truth.pressure.nu_c);
}

TEST(DensityFit, RecoversTable2FromTheTablesOwnStart) {
  const LawParameters<double> truth = published_parameters();
  LawParameters<double> law = start_parameters();
  const auto series = exact_series(truth, kDensities, 2);
  const std::vector<StageFit> fits = testing::run_stages(state_law_stages(kUnloadingLaw, series, "all"), law);
  ASSERT_EQ(fits.size(), 3u);
  for (const StageFit& fit : fits) EXPECT_TRUE(fit.stage.converged) << fit.stage.name << fit.stage.termination;
  EXPECT_EQ(fits[0].stage.name, "coordination");
  EXPECT_EQ(fits[0].stage.tests.size(), 2u);
  expect_recovered(law.isotropic, truth.isotropic, 1e-9);

  run_stage(overlap_stage(series, "all"), law, {}, {});
  EXPECT_NEAR(law.overlap_D, truth.overlap_D, 1e-9);
  run_stage(fabric_trace_stage(series, "all"), law, {}, {});
  EXPECT_NEAR(law.fabric_g3, truth.fabric_g3, 1e-12);
}

TEST(DensityFit, PressureDoesNotInheritTheMisfitOfCoordination) {
  // C* is off by 3 %, and P with it: Eq. (15) divides by the measured C, so that p0 stays what it is.
  const LawParameters<double> truth = published_parameters();
  auto series = exact_series(truth, kDensities, 2, 0.03);
  for (DensitySeries& s : series) {
    for (DensityPoint& p : s.points) p.P_star *= p.C_star / truth.isotropic.coordination.C_star(p.nu);
  }
  LawParameters<double> law = start_parameters();
  testing::run_stages(state_law_stages(kUnloadingLaw, series, "all"), law);
  EXPECT_NEAR(law.isotropic.pressure.p0, truth.isotropic.pressure.p0, 1e-9);
  EXPECT_NEAR(law.isotropic.pressure.nu_c, truth.isotropic.pressure.nu_c, 1e-9);
}

TEST(DensityFit, TwoDensitiesDoNotDetermineThreeParameters) {
  LawParameters<double> law = start_parameters();
  const auto series = exact_series(published_parameters(), {0.70, 0.74}, 2);
  const std::vector<StageFit> fits = testing::run_stages(state_law_stages(kSteadyLaw, series, "two"), law);
  for (const NamedEstimate& e : fits[0].stage.estimates) EXPECT_EQ(e.estimate.status, Status::not_identified) << e.name;
  for (const NamedEstimate& e : fits[1].stage.estimates) EXPECT_EQ(e.estimate.status, Status::fitted) << e.name;
  for (const NamedEstimate& e : fits[2].stage.estimates) EXPECT_EQ(e.estimate.status, Status::not_identified) << e.name;
  EXPECT_NE(fits[0].stage.estimates[0].estimate.note.find("2 of at least 3"), std::string::npos);
  EXPECT_EQ(fits[0].stage.estimates[0].name, "steady_coordination.C1");
}

TEST(DensityFit, OneSeriesHasValuesButNoErrors) {
  LawParameters<double> law = start_parameters();
  const auto series = exact_series(published_parameters(), kDensities, 1);
  for (const StageFit& fit : testing::run_stages(state_law_stages(kUnloadingLaw, series, "one"), law)) {
    for (const NamedEstimate& e : fit.stage.estimates) {
      EXPECT_EQ(e.estimate.status, Status::fitted) << e.name;
      EXPECT_TRUE(std::isnan(e.estimate.standard_error)) << e.name;
      EXPECT_NE(e.estimate.note.find("single packing"), std::string::npos) << e.name;
    }
  }
}

TEST(DensityFit, MissingOverlapsLeaveTheStageOut) {
  auto series = exact_series(published_parameters(), kDensities, 2);
  series[1].points[3].mean_overlap = std::nan("");
  LawParameters<double> law = start_parameters();
  const StageFit D = run_stage(overlap_stage(series, "all"), law, {}, {});
  EXPECT_EQ(D.stage.termination, "left out");
  EXPECT_EQ(D.stage.estimates.at(0).estimate.status, Status::not_identified);
  EXPECT_NE(D.stage.estimates[0].estimate.note.find("iso-1"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::fit
