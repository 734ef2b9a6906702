#include "chain/studies/prior_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "model/side_by_side.hpp"
#include "model/student.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

constexpr int kMany = 16;
constexpr std::array<std::size_t, 3> kFew{2, 3, 5};
constexpr std::size_t kGroups = 6;  // of each

/// Single fits side by side: their threads would wait for each other more than they work.
std::vector<fit::SizedLaw> fitted(const std::vector<std::vector<TestRecord>>& data, const Execution& execution) {
  std::vector<fit::SizedLaw> fits(data.size());
  side_by_side(data.size(), execution.threads, [&](std::size_t k) {
    if (execution.stop.stop_requested()) return;
    const fit::Calibration c = fit::calibrate(data[k], {}, {});
    fits[k] = {c.law, c.size};
  });
  if (execution.stop.stop_requested()) throw Interrupted("study prior: interrupted");
  return fits;
}

std::vector<TestRecord> tests_in(const fs::path& given) {
  return tests_of(read_dataset(dataset_folder(given)), Role::calibration);
}

/// Tests of disjoint groups of `size` packings.
std::vector<std::vector<TestRecord>> groups_of(const std::vector<TestRecord>& tests, std::size_t size) {
  std::set<std::uint64_t> all;
  for (const TestRecord& test : tests) all.insert(test.packing.seed);
  const std::vector<std::uint64_t> seeds(all.begin(), all.end());
  std::vector<std::vector<TestRecord>> groups;
  for (std::size_t first = 0; first + size <= seeds.size() && groups.size() < kGroups; first += size) {
    auto& group = groups.emplace_back();
    for (const TestRecord& test : tests) {
      const auto at = std::find(seeds.begin(), seeds.end(), test.packing.seed) - seeds.begin();
      if (std::cmp_greater_equal(at, first) && std::cmp_less(at, first + size)) group.push_back(test);
    }
  }
  return groups;
}

double mean_particles(const fit::SizedLaw& fit) { return fit.size.spheres / fit.size.packings; }

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// `whole` contains each part's packings, so that it is nearer to it than the truth is by sqrt(1 - part/whole).
FewPackings judged(const fit::SizedLaw& whole, const std::vector<fit::SizedLaw>& parts,
                   const fit::VariancePrior& prior) {
  FewPackings few;
  few.particles = mean_particles(whole);
  few.packings = parts.front().size.packings;
  few.calibrations = static_cast<int>(parts.size());
  double log_ratio = 0, inside = 0, inside_unmoderated = 0;
  std::vector<double> narrower;
  for (const fit::SizedLaw& part : parts) {
    CalibratedLaw moderated = part.law;
    log_ratio += std::log(fit::moderate(prior, part.size, moderated).ratio) / static_cast<double>(parts.size());
    const double nearer = std::sqrt(1 - part.size.spheres / whole.size.spheres);
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const double half = moderated.estimates[i].half_width(), alone = part.law.estimates[i].half_width();
      if (!std::isfinite(half) || !std::isfinite(whole.law.estimates[i].standard_error)) continue;
      const double off = std::abs(part.law.estimates[i].value - whole.law.estimates[i].value);
      inside += off <= half * nearer ? 1 : 0;
      inside_unmoderated += off <= alone * nearer ? 1 : 0;
      narrower.push_back(half / alone);
      ++few.intervals;
    }
  }
  few.ratio = std::exp(log_ratio);
  few.coverage = inside / few.intervals;
  few.unmoderated = inside_unmoderated / few.intervals;
  few.narrower = median(narrower);
  return few;
}

std::vector<SizeEffect> effects_of(const fit::SizedLaw& smaller, const fit::SizedLaw& larger) {
  std::vector<SizeEffect> effects;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const Estimate &a = smaller.law.estimates[i], &b = larger.law.estimates[i];
    if (!(a.standard_error > 0 && b.standard_error > 0)) continue;
    const double va = a.standard_error * a.standard_error, vb = b.standard_error * b.standard_error;
    // Welch's degrees of freedom
    const double d = (va + vb) * (va + vb) / (va * va / a.degrees_of_freedom + vb * vb / b.degrees_of_freedom);
    const double distance = (a.value - b.value) / std::sqrt(va + vb);
    effects.push_back({parameter_table()[i].name, mean_particles(smaller), a.value, a.standard_error,
                       mean_particles(larger), b.value, b.standard_error, distance,
                       std::abs(distance) > student_95(d)});
  }
  return effects;
}

}  // namespace

PriorStudy study_prior(const fs::path& many, const std::vector<fs::path>& others, const Execution& execution) {
  // In order: all of `many`, all of each of the others, then the groups of `many`.
  std::vector<std::vector<TestRecord>> data{tests_in(many)};
  if (const int packings = fit::size_of(data.front()).packings; packings < kMany)
    throw InvalidInput(
        fmt::format("{}: has {} packings; a prior of variances needs {} or more", many.string(), packings, kMany));
  for (const fs::path& other : others) data.push_back(tests_in(other));
  const std::size_t wholes = data.size();
  for (const std::size_t size : kFew) {
    for (auto& group : groups_of(data.front(), size)) data.push_back(std::move(group));
  }
  std::vector<fit::SizedLaw> fits = fitted(data, execution);
  const std::vector<fit::SizedLaw> parts(fits.begin() + 1, fits.end());
  const fit::SizedLaw& whole = fits.front();
  PriorStudy study{fit::variance_prior(whole, parts), {}, {}};
  for (const std::size_t size : kFew) {
    std::vector<fit::SizedLaw> few;
    std::copy_if(fits.begin() + static_cast<std::ptrdiff_t>(wholes), fits.end(), std::back_inserter(few),
                 [&](const fit::SizedLaw& part) { return std::cmp_equal(part.size.packings, size); });
    if (!few.empty()) study.few.push_back(judged(whole, few, study.prior));
  }
  for (std::size_t k = 1; k < wholes; ++k) {
    fit::moderate(study.prior, fits[k].size, fits[k].law);
    const std::vector<SizeEffect> effects = effects_of(whole, fits[k]);
    study.sizes.insert(study.sizes.end(), effects.begin(), effects.end());
  }
  return study;
}

}  // namespace grainlaw::chain
