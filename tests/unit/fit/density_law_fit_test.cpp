#include "fit/stages/density_law_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "model/parameters.hpp"

namespace grainlaw::fit {
namespace {

/// Shear fits on Table 3, one per density and seed; values off by +-`scatter` in turn.
std::vector<ShearFit> table3(const std::vector<double>& densities, int seeds, double scatter = 0) {
  const LawParameters<double> truth = published_parameters();
  std::vector<ShearFit> fits;
  for (const double nu : densities) {
    for (int seed = 0; seed < seeds; ++seed) {
      ShearFit fit;
      fit.test = "d2-" + std::to_string(nu) + "-" + std::to_string(seed);
      fit.nu = nu;
      for (const ShearQuantity& q : kShearQuantities) {
        const double sign = seed % 2 == 0 ? 1 : -1;
        (fit.*q.estimate).value = (truth.*q.law).value(nu, truth.shear_nu_c) * (1 + sign * scatter);
        (fit.*q.estimate).status = Status::fitted;
      }
      fits.push_back(fit);
    }
  }
  return fits;
}

std::vector<int> own_clusters(const std::vector<ShearFit>& fits) {
  std::vector<int> cluster;
  for (std::size_t i = 0; i < fits.size(); ++i) cluster.push_back(static_cast<int>(i));
  return cluster;
}

StageFit fit_law(const ShearQuantity& quantity, const std::vector<ShearFit>& fits, LawParameters<double>& law) {
  return run_stage(density_law_stage(quantity, fits, own_clusters(fits), law.shear_nu_c, {}), law, {}, {});
}

TEST(DensityLawFit, RecoversTable3) {
  const LawParameters<double> truth = published_parameters();
  const std::vector<ShearFit> fits = table3({0.68, 0.70, 0.74, 0.78, 0.82}, 1);
  LawParameters<double> law = start_parameters();
  for (const ShearQuantity& q : kShearQuantities) {
    const StageFit fit = fit_law(q, fits, law);
    EXPECT_TRUE(fit.stage.converged) << q.name << " " << fit.stage.termination;
    const ExponentialLaw<double>&found = law.*q.law, &expected = truth.*q.law;
    EXPECT_NEAR(found.Q_limit, expected.Q_limit, 1e-8 * expected.Q_c) << q.name;
    EXPECT_NEAR(found.Q_c, expected.Q_c, 1e-8 * expected.Q_c) << q.name;
    EXPECT_NEAR(found.alpha, expected.alpha, 1e-7 * expected.alpha) << q.name;
  }
}

TEST(DensityLawFit, ValuesWeighByTheMagnitudeOfTheirLawAtLeastAFifthOfTheMean) {
  const ExponentialLaw<double> law{0, 60, 20};
  std::vector<ShearFit> fits = table3({0.67, 0.70, 0.82}, 2);
  for (std::size_t i = 0; i < fits.size(); ++i)
    fits[i].beta_s.value = law.value(fits[i].nu, 0.6653) * (i % 2 == 0 ? 0.5 : 1.5);
  const Problem problem =
      problem_of(density_law_stage(kShearQuantities[1], fits, own_clusters(fits), 0.6653, {}), start_parameters());
  ASSERT_EQ(problem.blocks.size(), 6u);
  for (const std::size_t i : {0u, 1u, 2u, 3u})
    EXPECT_NEAR(problem.blocks[i].weight(0) * law.value(fits[i].nu, 0.6653), 1, 1e-9)
        << "not by a half or three halves";
  double mean = 0;
  for (const double nu : {0.67, 0.70, 0.82}) mean += law.value(nu, 0.6653) / 3;
  for (const std::size_t i : {4u, 5u}) EXPECT_NEAR(problem.blocks[i].weight(0), 5 / mean, 1e-9);
}

// What all laws are off by no number of packings mends: values that scatter by 15 % give back the law that they scatter about.
TEST(DensityLawFit, TheMeanOfManyLawsIsTheLaw) {
  const LawParameters<double> truth = published_parameters();
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  for (const ShearQuantity& q : {kShearQuantities[0], kShearQuantities[2]}) {
    const int sets = 100;
    double off = 0;
    for (int set = 0; set < sets; ++set) {
      std::vector<ShearFit> fits = table3({0.68, 0.70, 0.74, 0.78, 0.82}, 20);
      for (ShearFit& fit : fits) (fit.*q.estimate).value *= 1 + 0.15 * std::clamp(normal(engine), -3., 3.);
      LawParameters<double> law = truth;
      fit_law(q, fits, law);
      off += ((law.*q.law).value(0.74, law.shear_nu_c) / (truth.*q.law).value(0.74, law.shear_nu_c) - 1) / sets;
    }
    EXPECT_NEAR(off, 0, 0.01) << q.name;
  }
}

TEST(DensityLawFit, ThreeDensitiesDetermineTheCurveAndSeedsTheError) {
  LawParameters<double> law = start_parameters();
  const ShearQuantity& s_max = kShearQuantities[0];
  const std::vector<ShearFit> one = table3({0.68, 0.72, 0.80}, 1);
  for (const NamedEstimate& e : fit_law(s_max, one, law).stage.estimates) {
    EXPECT_EQ(e.estimate.status, Status::fitted) << e.name;
    EXPECT_TRUE(std::isnan(e.estimate.standard_error)) << "no degree of freedom left: " << e.name;
  }
  const std::vector<ShearFit> two = table3({0.68, 0.72, 0.80}, 2, 0.02);
  for (const NamedEstimate& e : fit_law(s_max, two, law).stage.estimates) {
    EXPECT_EQ(e.estimate.status, Status::fitted) << e.name;
    EXPECT_GT(e.estimate.standard_error, 0) << e.name;
  }
}

TEST(DensityLawFit, FewerDensitiesMeetTheirValuesButIdentifyNothing) {
  for (const std::vector<double>& densities : {std::vector<double>{0.70}, std::vector<double>{0.70, 0.78}}) {
    const std::vector<ShearFit> fits = table3(densities, 2);
    LawParameters<double> law = start_parameters();
    for (const ShearQuantity& q : kShearQuantities) {
      const StageFit fit = fit_law(q, fits, law);
      for (const NamedEstimate& e : fit.stage.estimates) {
        EXPECT_EQ(e.estimate.status, Status::not_identified) << e.name;
        EXPECT_TRUE(std::isnan(e.estimate.standard_error)) << e.name;
        EXPECT_FALSE(e.estimate.note.empty());
      }
      EXPECT_EQ(fit.covariance().norm(), 0);
      for (const ShearFit& f : fits) {
        const double value = (f.*q.estimate).value;
        EXPECT_NEAR((law.*q.law).value(f.nu, law.shear_nu_c), value, 1e-5 * value) << q.name;
      }
    }
  }
}

TEST(DensityLawFit, AConstantIsALawOfItsOwn) {
  std::vector<ShearFit> fits = table3({0.68, 0.70, 0.74, 0.78}, 2);
  for (std::size_t i = 0; i < fits.size(); ++i)
    fits[i].s_max.value = 0.15 + 0.001 * fits[i].nu;  // grows: decays nowhere
  LawParameters<double> law = start_parameters();
  const StageFit fit = fit_law(kShearQuantities[0], fits, law);
  EXPECT_TRUE(fit.stage.converged) << fit.stage.termination;
  EXPECT_EQ(fit.stage.estimates[0].estimate.status, Status::fitted);
  EXPECT_EQ(fit.stage.estimates[1].estimate.status, Status::at_bound);
  EXPECT_EQ(fit.stage.estimates[2].estimate.status, Status::fixed) << fit.stage.estimates[2].estimate.note;
  EXPECT_NEAR(law.stress_ratio_max.Q_limit, 0.1507, 1e-4);
}

TEST(DensityLawFit, ARateWithoutTrendKeepsItsCurve) {
  std::vector<ShearFit> fits = table3({0.68, 0.70, 0.74, 0.78}, 2);
  for (std::size_t i = 0; i < fits.size(); ++i) fits[i].beta_s.value = 45 - 10 * fits[i].nu + (i % 2 == 0 ? 1 : -1);
  LawParameters<double> law = start_parameters();
  const StageFit fit = fit_law(kShearQuantities[1], fits, law);
  for (const NamedEstimate& e : fit.stage.estimates) EXPECT_NE(e.estimate.status, Status::not_identified) << e.name;
  EXPECT_NEAR(law.stress_rate.value(0.72, law.shear_nu_c), 45 - 7.2, 0.1);
}

TEST(DensityLawFit, TestsThatShowedNothingAreLeftOut) {
  std::vector<ShearFit> fits = table3({0.68, 0.70, 0.74, 0.78}, 1);
  fits[0].s_max = {1e9, std::nan(""), Status::not_identified, "short"};
  LawParameters<double> law = start_parameters();
  const StageFit fit = fit_law(kShearQuantities[0], fits, law);
  EXPECT_EQ(fit.stage.residuals, 3);
  EXPECT_NEAR(law.stress_ratio_max.value(0.70, law.shear_nu_c), fits[1].s_max.value, 1e-6);
  for (ShearFit& f : fits) f.s_max.status = Status::not_identified;
  EXPECT_EQ(fit_law(kShearQuantities[0], fits, law).stage.termination, "left out");
}

}  // namespace
}  // namespace grainlaw::fit
