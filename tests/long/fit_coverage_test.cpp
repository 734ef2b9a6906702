// Hard cases F2 and F3 for the complete calibration, all stages up to memory, 1000 data sets each: white noise of 1 %, noise
// correlated from row to row, and packings that differ as a whole. Pass lines 93-97 % for white noise and 90 % otherwise. Of five
// white packings 2000: by the first 1000 chi was covered by 92.8 %, by the others 95.2 %; 1000 leave the least of 41 to chance.
// By Huber's loss (F7) 300 sets of packings that differ, by the same line.

#include <gtest/gtest.h>

#include "tests/support/fit_coverage.hpp"

namespace grainlaw {
namespace {

using testing::CoverageStudy;

class Coverage : public ::testing::TestWithParam<CoverageStudy> {};

TEST_P(Coverage, F2F3CompleteCalibration) {
  const CoverageStudy& study = GetParam();
  const testing::Coverage coverage = testing::coverage_of_calibration(study);
  const bool white = study.correlation == 0 && study.packing_scatter == 0;
  const std::string name = (study.loss == fit::Loss::huber ? "F7." : white ? "F2." : "F3.") + study.name();
  testing::coverage_table(name, coverage);
  ASSERT_EQ(coverage.counts().size(), kParameterCount - 4);  // nu_c of shear, m, g and a0 are not fitted
  for (const auto& [parameter, count] : coverage.counts()) EXPECT_EQ(count.sets, study.sets) << parameter;
  const double least = white ? 0.93 : 0.90, most = white ? 0.97 : 1;
  testing::expect_coverage(name, coverage, least, most);
}

// Packings that differ: a calibration finds on average what it finds without any noise. The mean of n sets differs from that by
// chance by sqrt(1/n) standard deviations of a set.
TEST(CoverageOfPackingsThatDiffer, IsOfWhatNoNoiseGives) {
  const CoverageStudy study{80, 10, 0.9, 0.02, 1300000};
  const testing::Coverage coverage = testing::coverage_of_calibration(study);
  testing::coverage_table(study.name(), coverage);
  for (const auto& [parameter, count] : coverage.counts())
    EXPECT_LE(std::abs(count.distance()), 4 * std::sqrt(1. / study.sets)) << parameter;
}

// The intervals of Huber's loss (F7), by the same lines. Moderated ones are in the default suite.
TEST(CoverageByHubersLoss, F7IsotropicLaws) {
  const CoverageStudy white{1000, 10, 0, 0, 40000, fit::Loss::huber};
  testing::expect_coverage("F7.isotropic." + white.name(), testing::coverage_of_isotropic_laws(white), 0.93, 0.97);
  const CoverageStudy correlated{1000, 3, 0.9, 0, 50000, fit::Loss::huber};
  testing::expect_coverage("F7.isotropic." + correlated.name(), testing::coverage_of_isotropic_laws(correlated), 0.90,
                           1);
}

// Moderated (docs/theory/fit.md): from two packings on, both losses, over several priors. Of ten packings, and of five by Huber's
// loss, 1000 sets, laws over density 8000: 300 and 2000 once left a parameter so near the line that chance decided. Each was decided on
// before more were seen.
class CoverageModerated : public Coverage {};

TEST_P(CoverageModerated, IsotropicLaws) {
  CoverageStudy study = GetParam();
  study.sets = 8000;
  study.priors = 40;
  const testing::Coverage coverage = testing::coverage_of_isotropic_laws(study);
  testing::coverage_table("moderated.isotropic." + study.name(), coverage);
  testing::expect_coverage("moderated.isotropic." + study.name(), coverage, 0.93, 1);
}

TEST_P(CoverageModerated, CompleteCalibration) {
  const CoverageStudy& study = GetParam();
  const testing::Coverage coverage = testing::coverage_of_calibration(study);
  testing::coverage_table("moderated." + study.name(), coverage);
  testing::expect_coverage("moderated." + study.name(), coverage, 0.90, 1);
}

const auto kNameOfStudy = [](const auto& study) {
  std::string name = study.param.name();
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
};

INSTANTIATE_TEST_SUITE_P(Studies, CoverageModerated,
                         ::testing::Values(CoverageStudy{300, 2, 0.9, 0.02, 1000000, fit::Loss::squares, 10, 1300000},
                                           CoverageStudy{300, 3, 0.9, 0.02, 1100000, fit::Loss::squares, 10, 1300000},
                                           CoverageStudy{300, 5, 0.9, 0.02, 1200000, fit::Loss::squares, 10, 1300000},
                                           CoverageStudy{1000, 10, 0.9, 0.02, 1300000, fit::Loss::squares, 10, 1300000},
                                           CoverageStudy{300, 2, 0.9, 0.02, 1400000, fit::Loss::huber, 10, 1700000},
                                           CoverageStudy{300, 3, 0.9, 0.02, 1500000, fit::Loss::huber, 10, 1700000},
                                           CoverageStudy{1000, 5, 0.9, 0.02, 1600000, fit::Loss::huber, 10, 1700000},
                                           CoverageStudy{300, 10, 0.9, 0.02, 1700000, fit::Loss::huber, 10, 1700000}),
                         kNameOfStudy);

INSTANTIATE_TEST_SUITE_P(
    Studies, Coverage,
    ::testing::Values(CoverageStudy{1000, 3, 0, 0, 100000}, CoverageStudy{2000, 5, 0, 0, 200000},
                      CoverageStudy{1000, 10, 0, 0, 300000}, CoverageStudy{1000, 3, 0.5, 0, 400000},
                      CoverageStudy{1000, 3, 0.9, 0, 500000}, CoverageStudy{1000, 5, 0.9, 0, 600000},
                      CoverageStudy{1000, 10, 0.9, 0, 700000}, CoverageStudy{1000, 3, 0.9, 0.02, 800000},
                      CoverageStudy{300, 3, 0.9, 0.02, 900000, fit::Loss::huber}),
    kNameOfStudy);

}  // namespace
}  // namespace grainlaw
