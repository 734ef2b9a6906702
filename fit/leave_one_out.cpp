#include "fit/leave_one_out.hpp"

#include <cmath>
#include <set>

#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

LeftOut without(std::uint64_t seed, const std::vector<TestRecord>& tests, const CalibrationOptions& options,
                const RunControl& control) {
  std::vector<TestRecord> part;
  for (const TestRecord& test : tests) {
    if (test.packing.seed != seed) part.push_back(test);
  }
  LeftOut left{seed, std::vector<double>(kParameterCount, kUndefined), ""};
  try {
    const Calibration calibration = calibrate(part, options, control);
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      if (calibration.law.estimates[i].status != Status::not_identified)
        left.value[i] = *fields(calibration.law.parameters)[i];
    }
    if (!calibration.law.converged) left.note = "did not converge";
  } catch (const InvalidInput& error) {
    left.note = error.what();
  }
  return left;
}

}  // namespace

std::vector<LeftOut> leave_one_out(const std::vector<TestRecord>& tests, const CalibrationOptions& options,
                                   const RunControl& control) {
  std::set<std::uint64_t> seeds;
  for (const TestRecord& test : tests) seeds.insert(test.packing.seed);
  std::vector<LeftOut> fits;
  if (seeds.size() < 2) return fits;
  CalibrationOptions plain = options;
  plain.profiles = false;
  RunControl one = control;  // told of all of them together
  if (control.report)
    one.report = [&](Progress progress) {
      progress.fraction = (static_cast<double>(fits.size()) + progress.fraction) / static_cast<double>(seeds.size());
      control.report(progress);
    };
  for (const std::uint64_t seed : seeds) fits.push_back(without(seed, tests, plain, one));
  return fits;
}

double jackknife_error(const std::vector<LeftOut>& fits, std::size_t i) {
  const double n = static_cast<double>(fits.size());
  double mean = 0, squares = 0;
  for (const LeftOut& fit : fits) mean += fit.value[i] / n;
  for (const LeftOut& fit : fits) squares += (fit.value[i] - mean) * (fit.value[i] - mean);
  return fits.empty() ? kUndefined : std::sqrt((n - 1) / n * squares);
}

const LeftOut* furthest(const std::vector<LeftOut>& fits, std::size_t i, double value) {
  const LeftOut* found = nullptr;
  for (const LeftOut& fit : fits) {
    if (std::isnan(fit.value[i])) continue;
    if (found == nullptr || std::abs(fit.value[i] - value) > std::abs(found->value[i] - value)) found = &fit;
  }
  return found;
}

}  // namespace grainlaw::fit
