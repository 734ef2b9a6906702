#pragma once
// What many packings say of the errors of few (docs/theory/fit.md, Moderated variances): the prior of their variances, and by
// the same packings how often the intervals of few hold what many find, with it and without. Also what fewer spheres bias.

#include <filesystem>
#include <string>
#include <vector>

#include "fit/calibrate.hpp"
#include "model/files/dataset.hpp"
#include "model/files/execution.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw::chain {

/// Calibrations of so many packings each, disjoint ones of one data set, against the calibration of all of it.
struct FewPackings {
  std::string data;      ///< folder of the data set
  double particles = 0;  ///< of a packing, mean
  int packings = 0;      ///< of each calibration
  int calibrations = 0;
  double ratio = 0;     ///< of variances to the prior's, carried to this size, geometric mean, chance taken out
  int intervals = 0;    ///< of all parameters and calibrations together
  double coverage = 0;  ///< share of moderated intervals that hold the value of all packings; to be compared with .95
  double unmoderated = 0;  ///< likewise, by the packings at hand alone
  double narrower = 0;     ///< median of moderated over unmoderated half width
};
GRAINLAW_FIELDS(FewPackings, data, particles, packings, calibrations, ratio, intervals, coverage, unmoderated,
                narrower);

/// A parameter found by packings of one size and of another, each by all that there are.
struct SizeEffect {
  std::string parameter;
  double particles = 0, value = 0, standard_error = 0;  ///< of the smaller packings
  double larger_particles = 0, larger_value = 0, larger_standard_error = 0;
  double distance = 0;  ///< difference over the joint standard error
  bool biased = false;  ///< beyond Student's 95 % range
};
GRAINLAW_FIELDS(SizeEffect, parameter, particles, value, standard_error, larger_particles, larger_value,
                larger_standard_error, distance, biased);

struct PriorStudy {
  fit::VariancePrior prior;
  std::vector<FewPackings> few;
  std::vector<SizeEffect> sizes;
};

/// The prior of the data set in `many`, its degrees of freedom by calibrations of 2, 3 and 5 of its packings (six of each)
/// and by those of all of each of `others`, data sets of like tests on packings of other sizes, against which `many` is set
/// for what the size biases. Throws InvalidInput where `many` has less than 16 packings; Interrupted.
PriorStudy study_prior(const std::filesystem::path& many, const std::vector<std::filesystem::path>& others,
                       const Execution& execution);

}  // namespace grainlaw::chain
