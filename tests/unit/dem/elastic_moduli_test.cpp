#include "dem/statics/elastic_moduli.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/vocabulary/error.hpp"
#include "model/vocabulary/path.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

State packing(double nu, std::uint64_t seed = 2, std::size_t n = 150) {
  scene::Draw draw(seed);
  return scene::random_state(n, 3, nu, scene::cubic(1), draw);
}

Deviator<double> direction(Mode mode) { return -deviator<double>(direction_of(mode).tensor).normalized(); }

double difference(const Moduli& a, const Moduli& b) {
  return std::max({std::abs(a.B - b.B), std::abs(a.DG - b.DG), std::abs(a.A1 - b.A1), std::abs(a.A2 - b.A2)});
}

TEST(ElasticModuli, StepsGiveTheLinearResponseWhateverTheirSize) {
  for (const double nu : {0.68, 0.72, 0.80}) {
    const ElasticProbe probe = probe_moduli(packing(nu), direction(Mode::D2), {.steps = {1e-8, 1e-7, 1e-6}}, {});
    ASSERT_TRUE(probe.relaxed && probe.stable) << "nu = " << nu;
    for (const ElasticSteps& step : probe.steps) {
      ASSERT_EQ(step.contacts_closed + step.contacts_opened, 0u) << "nu = " << nu << ", h = " << step.h;
      EXPECT_EQ(step.rearranged, 0);
      // central differences: rounding over h, and (h times a few hundred)^2
      const double bound = (1e-13 / step.h + 1e5 * step.h * step.h) * probe.moduli.B;
      EXPECT_LE(difference(step.central, probe.moduli), bound) << "nu = " << nu << ", h = " << step.h;
      EXPECT_LE(step.asymmetry_vol, 1e-7 + 1e3 * step.h);
      EXPECT_LE(step.asymmetry_dev, 1e-6 + 1e3 * step.h);
    }
  }
}

TEST(ElasticModuli, StepsAlongAnyDirection) {
  const Deviator<double> oblique = (Deviator<double>() << 0.3, -0.2, 0.5, -0.7, 0.4).finished().normalized();
  const ElasticProbe probe = probe_moduli(packing(0.75), oblique, {.steps = {1e-7}}, {});
  ASSERT_TRUE(probe.relaxed && probe.stable);
  ASSERT_EQ(probe.steps[0].contacts_closed + probe.steps[0].contacts_opened, 0u);
  EXPECT_LE(difference(probe.steps[0].central, probe.moduli), 1e-5 * probe.moduli.B);
  EXPECT_NEAR(probe.moduli.DG, oblique.dot(probe.tangent.bottomRightCorner<5, 5>() * oblique), 1e-12 * probe.moduli.DG);
}

TEST(ElasticModuli, CouplingsFollowOneAnother) {
  const ElasticProbe probe = probe_moduli(packing(0.70, 5), direction(Mode::D3), {}, {});
  ASSERT_TRUE(probe.stable);
  const double P = probe.state.stress.tensor.trace() / 3, sigma_par = probe.state.s_par * P;
  EXPECT_GT(std::abs(sigma_par), 1e-3 * P);
  EXPECT_NEAR(probe.moduli.A1, 2.0 / 3 * (probe.moduli.A2 - sigma_par), 1e-7 * probe.moduli.B);
  EXPECT_LT(probe.moduli.B, probe.B_affine);
}

TEST(ElasticModuli, LargeStepsAreSeenToChangeContactsAndToRearrange) {
  const ElasticProbe probe = probe_moduli(packing(0.68), direction(Mode::D2), {.steps = {1e-7, 5e-3}}, {});
  ASSERT_EQ(probe.steps.size(), 2u);
  EXPECT_EQ(probe.steps[0].rearranged, 0);
  EXPECT_LT(probe.steps[0].hysteresis, 1e-4);
  EXPECT_GT(probe.steps[1].contacts_closed, 0u);
  EXPECT_GT(probe.steps[1].contacts_opened, 0u);
  EXPECT_GT(probe.steps[1].rearranged, 0);
  EXPECT_GT(probe.steps[1].hysteresis, 1e-3);
}

TEST(ElasticModuli, SameBitsForAnyNumberOfThreads) {
  const ElasticProbe one = probe_moduli(packing(0.70, 3, 600), direction(Mode::D2), {.threads = 1}, {});
  const ElasticProbe three = probe_moduli(packing(0.70, 3, 600), direction(Mode::D2), {.threads = 3}, {});
  EXPECT_EQ(one.tangent, three.tangent);
  EXPECT_EQ(one.steps[0].central.DG, three.steps[0].central.DG);
  EXPECT_EQ(one.passes, three.passes);
}

TEST(ElasticModuli, WithoutLoadThereIsNothingToMeasure) {
  const ElasticProbe probe = probe_moduli(packing(0.40), direction(Mode::D2), {}, {});
  EXPECT_TRUE(probe.relaxed);
  EXPECT_EQ(probe.spheres, 0u);
  EXPECT_FALSE(probe.stable);
  EXPECT_TRUE(std::isnan(probe.moduli.B) && std::isnan(probe.moduli.A2));
  EXPECT_TRUE(probe.steps.empty());
}

TEST(ElasticModuli, RefusesWhatItCannotTake) {
  const State state = packing(0.70);
  EXPECT_THROW(probe_moduli(state, 2 * direction(Mode::D2), {}, {}), InvalidInput);
  for (const double h : {0.0, -1e-6, 0.02, std::nan("")}) {
    EXPECT_THROW(probe_moduli(state, direction(Mode::D2), {.steps = {h}}, {}), InvalidInput);
  }
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(probe_moduli(state, direction(Mode::D2), {}, {{}, stop.get_token()}), Interrupted);
}

}  // namespace
}  // namespace grainlaw::dem
