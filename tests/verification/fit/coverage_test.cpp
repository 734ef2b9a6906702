// Hard cases F2 and F3 in what is fast: 1000 data sets for the laws over density, whose stages are fitted for themselves, and
// a few for the complete calibration. Full numbers of the latter are in tests/long.

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "fit/stages/evolution_fit.hpp"
#include "tests/support/fit_coverage.hpp"

namespace grainlaw {
namespace {

using testing::CoverageStudy;

// Pass line 93-97 % for white noise, 90 % for correlated noise.
class Coverage : public ::testing::TestWithParam<int> {};

TEST_P(Coverage, F2IsotropicLaws) {
  const CoverageStudy study{1000, GetParam(), 0, 0, 1000};
  testing::expect_coverage("F2.isotropic." + study.name(), testing::coverage_of_isotropic_laws(study), 0.93, 0.97);
}

TEST_P(Coverage, F2SteadyLaws) {
  const CoverageStudy study{1000, GetParam(), 0, 0, 5000};
  testing::expect_coverage("F2.steady." + study.name(), testing::coverage_of_steady_laws(study), 0.93, 0.97);
}

TEST_P(Coverage, F3IsotropicLawsFromCorrelatedRows) {
  for (const double rho : {0.5, 0.9}) {
    const CoverageStudy study{1000, GetParam(), rho, 0, 20000};
    testing::expect_coverage("F3.isotropic." + study.name(), testing::coverage_of_isotropic_laws(study), 0.90, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Packings, Coverage, ::testing::Values(3, 5, 10));

// What every set is off by no number of packings mends. The mean of 400 sets is known to .05 standard deviations of a set; before the
// data's side of Eq. (15) kept the start's nu_c, that of the pressure lay .91 too low here.
TEST(MeanOverSets, OfLawsOverDensityIsWhatWasPutIn) {
  const testing::Coverage coverage = testing::coverage_of_isotropic_laws({400, 10, 0, 0.02, 80000});
  ASSERT_EQ(coverage.counts().size(), 10);
  for (const auto& [parameter, count] : coverage.counts()) EXPECT_LE(std::abs(count.distance()), 0.2) << parameter;
}

// Likewise where contacts were not counted, and C on the data's side is that of an assumed law from the fitted nu_c on.
TEST(MeanOverSets, OfThePressureWithoutContactsIsWhatWasPutIn) {
  LawParameters<double> truth = testing::interior_truth();
  StateLaw<double>& law = truth.steady;
  law.coordination.nu_c = law.pressure.nu_c;
  testing::Coverage coverage;
  for (std::uint64_t set = 0; set < 400; ++set) {
    testing::RowNoise noise(0.02, 90000 + set);
    std::vector<fit::DensitySeries> series;
    for (int packing = 0; packing < 10; ++packing) {
      const double factor = noise.factor();
      for (const double nu : {0.675, 0.68, 0.69, 0.70, 0.72, 0.75, 0.78, 0.82}) {
        fit::DensityPoint point{nu, Observation::undefined, Observation::undefined, 0, 1, 1};
        point.P_star = law.P_star(nu) * factor * noise.factor();
        series.push_back({fmt::format("d2-{}-{}", nu, packing), packing, 0, {point}});
      }
    }
    LawParameters<double> found = truth;
    for (const fit::StageFit& fit :
         testing::run_stages({fit::pressure_of_assumed_contacts(fit::kSteadyLaw, series, "F2")}, found))
      coverage.add(fit.stage.estimates, truth);
  }
  ASSERT_EQ(coverage.counts().size(), 3);
  for (const auto& [parameter, count] : coverage.counts()) EXPECT_LE(std::abs(count.distance()), 0.2) << parameter;
}

// Likewise of Eq. (16) along isotropic unloading, by packings whose P* differs by 10 % as a whole: 200 sets know the mean to .07.
// Weights by each row's own P* put p0 .52 too low.
TEST(MeanOverSets, OfThePressureAlongUnloadingIsWhatWasPutIn) {
  const LawParameters<double> truth = testing::interior_truth();
  const std::vector<std::string> held{"stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate"};
  testing::SyntheticOptions few_rows;
  few_rows.rows = 12;
  testing::SyntheticDataset maker(truth, few_rows);
  testing::Coverage coverage;
  for (std::uint64_t set = 0; set < 200; ++set) {
    testing::RowNoise noise(0.1, 95000 + set);
    std::vector<TestRecord> tests{
        maker.test("d2", 1, 0.70, {testing::synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.05)})};
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      tests.push_back(maker.isotropic_unloading(seed));
      const double factor = noise.factor();
      for (Observation& row : tests.back().rows) row.P_star *= factor, row.stress.tensor *= factor;
    }
    const fit::DataSet data = fit::check_and_sort(tests);
    auto all = fit::trajectories_of(data, truth.isotropic.pressure.nu_c, {});
    std::erase_if(all, [](const fit::Trajectory& t) { return !t.starts_on_law; });
    LawParameters<double> found = truth;  // the stage of the pressure says what rows are relative to
    testing::run_stages({fit::state_law_stages(fit::kUnloadingLaw, isotropic_series(data, {}), "").back()}, found);
    for (const fit::StageFit& fit : testing::run_stages({fit::evolution_stage(all, held, {})}, found)) {
      for (const fit::NamedEstimate& e : fit.stage.estimates)
        if (e.name == "pressure.p0") coverage.add(e, truth);
    }
    EXPECT_NEAR(found.isotropic.pressure.nu_c, truth.isotropic.pressure.nu_c, 1e-5) << "no packing's curve bends";
  }
  ASSERT_EQ(coverage.counts().size(), 1);
  EXPECT_LE(std::abs(coverage.counts().at("pressure.p0").distance()), 0.28);
}

// Moderated by the variances of 64 packings of the same kind: two packings hold what they promise, and with an interval that
// says something. 500 sets: of a true 95 % one parameter in 10^4 would fall below .913. Full numbers are in tests/long.
class CoverageModerated : public ::testing::TestWithParam<std::tuple<int, fit::Loss>> {};

TEST_P(CoverageModerated, IsotropicLaws) {
  const auto [packings, loss] = GetParam();
  const CoverageStudy study{500, packings, 0.9, 0.02, 60000, loss, 5};
  testing::expect_coverage("moderated.isotropic." + study.name(), testing::coverage_of_isotropic_laws(study), 0.91, 1);
}

INSTANTIATE_TEST_SUITE_P(Packings, CoverageModerated,
                         ::testing::Combine(::testing::Values(2, 5),
                                            ::testing::Values(fit::Loss::squares, fit::Loss::huber)));

// 40 sets: were an interval to hold 90 % only, as many as 11 misses would happen to one parameter in 800; 14 to one in 10^5.
TEST(CoverageOfAll, F3ACompleteCalibrationInReducedNumber) {
  const CoverageStudy study{40, 3, 0.9, 0, 70000};
  testing::expect_coverage("F3.reduced." + study.name(), testing::coverage_of_calibration(study), 1 - 11. / 40, 1);
}

// From two packings an error is itself chance by a factor of two: one of .90 of the value withdraws nothing, one of 1.4 does.
TEST(WithdrawnParameters, ErrorsAreJudgedByTheirOwnDegreesOfFreedom) {
  const CoverageStudy study{1, 2, 0.9, 0.02, 1400000, fit::Loss::huber};
  const auto G = [&](int set) {
    return testing::CompleteCalibration().fitted(study, set).law.estimates[parameter_index("memory.G")];
  };
  const Estimate kept = G(21), withdrawn = G(3);
  EXPECT_EQ(kept.status, Status::fitted) << kept.note;
  EXPECT_GT(kept.standard_error, 0.5 * kept.value);
  EXPECT_LT(kept.degrees_of_freedom, 3);
  EXPECT_EQ(withdrawn.status, Status::not_identified) << withdrawn.note;
}

}  // namespace
}  // namespace grainlaw
