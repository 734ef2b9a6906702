#include "chain/planning/precision_plan.hpp"

#include <algorithm>
#include <cmath>

#include "model/student.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kRateOrder = 0.6;
constexpr int kLeastPackings = 3;  // two say nearly nothing of their scatter: t = 12.7

double mean_factor(const PlanSettings& s) {
  return student_95(s.packings - 1) / std::sqrt(s.packings * static_cast<double>(s.particles));
}

/// g of the densities and the strain of `settings`.
double steady_factor(const std::vector<SteadyScatter>& scatter, const PlanSettings& settings) {
  const auto at = std::ranges::find_if(
      scatter, [&](const SteadyScatter& s) { return std::abs(s.shear_strain - settings.shear_strain) < 1e-9; });
  if (at == scatter.end()) throw Error("plan: no scatter is known for a shear strain that it considers");
  return std::sqrt(at->between + at->within / settings.densities);
}

int finished_packings(const PlanSettings& settings, const std::vector<PlanSettings>& finished) {
  int packings = 0;
  for (const PlanSettings& round : finished) {
    if (same_packings(settings, round)) packings = std::max(packings, round.packings);
  }
  return packings;
}

/// Fewest packings with twice the spheres of each round that said nothing although it sheared as far, at as many densities.
int packings_for_a_band(const PlanSettings& settings, const std::vector<PlanSettings>& without_band) {
  std::int64_t spheres = 0;
  for (const PlanSettings& round : without_band) {
    if (settings.shear_strain > round.shear_strain || settings.densities > round.densities) continue;
    spheres = std::max(spheres, 2 * round.packings * round.particles);
  }
  return static_cast<int>((spheres + settings.particles - 1) / settings.particles);
}

double seconds_for(const PlanSettings& settings, const Work& work, const CostRates& rates,
                   const std::vector<PlanSettings>& finished) {
  const int missing = std::max(0, settings.packings - finished_packings(settings, finished));
  return missing * ((work.preparation + work.tests) * rates.particle_step + work.relaxed * rates.relaxed) +
         settings.packings * work.fitted_tests * rates.fitted_test;
}

/// Smallest n in [low, high] for which `is` holds; it holds from some n on, at `high` at the latest.
template <class Predicate>
int first_from(int low, int high, const Predicate& is) {
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (is(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

}  // namespace

bool same_packings(const PlanSettings& a, const PlanSettings& b) {
  return a.particles == b.particles && a.strain_rate == b.strain_rate && a.time_step_fraction == b.time_step_fraction &&
         a.densities == b.densities && a.shear_strain == b.shear_strain;
}

double shape(Cause cause, const PlanSettings& settings, const Scale& scale) {
  const PlanSettings& pilot = scale.pilot;
  switch (cause) {
    case Cause::strain_rate:
      return std::pow(settings.strain_rate / pilot.strain_rate, kRateOrder) -
             std::pow(scale.wanted_rate / pilot.strain_rate, kRateOrder);
    case Cause::time_step:
      return std::pow(settings.time_step_fraction / pilot.time_step_fraction, 2);
    case Cause::size:
      break;
  }
  return static_cast<double>(pilot.particles) / static_cast<double>(settings.particles);
}

Bias bias_of(double difference, double standard_error, double apart) {
  const double excess = difference * difference - standard_error * standard_error;
  return {difference, standard_error, std::sqrt(std::max(0.0, excess)) / apart, 2 * standard_error / apart};
}

Work scaled(const Work& work, const PlanSettings& at, const PlanSettings& settings) {
  const double size = static_cast<double>(settings.particles) / static_cast<double>(at.particles);
  const double steps =
      size * at.strain_rate / settings.strain_rate * at.time_step_fraction / settings.time_step_fraction;
  return {work.preparation * steps, work.tests * steps, work.relaxed * size, work.fitted_tests};
}

PlanFindings rebased(PlanFindings findings, const PlanSettings& settings, const std::vector<double>& half_widths) {
  for (std::size_t q = 0; q < findings.quantities.size(); ++q) findings.quantities[q].half_width = half_widths.at(q);
  findings.reference = settings;
  return findings;
}

double ExpectedError::total() const {
  double squares = half_width * half_width;
  for (const double bias : biases) squares += bias * bias;
  return std::sqrt(squares);
}

ExpectedError expected(const QuantityFindings& quantity, const PlanFindings& findings, const PlanSettings& settings) {
  const PlanSettings& reference = findings.reference;
  ExpectedError error;
  error.quantity = quantity.quantity;
  error.half_width = std::isfinite(quantity.half_width) ? quantity.half_width : 1;
  error.half_width *= mean_factor(settings) / mean_factor(reference);
  const double g0 = steady_factor(quantity.scatter, reference);
  if (g0 > 0) error.half_width *= steady_factor(quantity.scatter, settings) / g0;
  for (std::size_t i = 0; i < kCauses.size(); ++i)
    error.biases[i] = quantity.biases[i].slope * shape(kCauses[i], settings, findings.scale);
  return error;
}

Candidate candidate_with(const PlanSettings& settings, const Work& work, const PlanFindings& findings,
                         const PlanGoal& goal) {
  Candidate c{settings, work, {}, 0, seconds_for(settings, work, findings.rates, goal.finished), false};
  for (const QuantityFindings& quantity : findings.quantities) {
    c.errors.push_back(expected(quantity, findings, settings));
    c.error = std::max(c.error, c.errors.back().total());
  }
  c.reaches = c.error <= goal.error;
  return c;
}

std::optional<Candidate> candidate(const PlanSettings& settings, const Work& work, const PlanFindings& findings,
                                   const PlanGoal& goal) {
  const auto with = [&](int packings) {
    PlanSettings s = settings;
    s.packings = packings;
    return candidate_with(s, work, findings, goal);
  };
  const int first = std::max({kLeastPackings, finished_packings(settings, goal.finished) + 1,
                              packings_for_a_band(settings, goal.without_band)});
  const auto too_long = [&](int n) {
    PlanSettings s = settings;
    s.packings = n;
    return n > goal.max_packings || seconds_for(s, work, findings.rates, goal.finished) > goal.seconds_left;
  };
  if (too_long(first)) return std::nullopt;
  const int end = first_from(first, goal.max_packings + 1, too_long);
  const int needed = first_from(first, end, [&](int n) { return n == end || with(n).reaches; });
  if (needed < end) return with(needed);
  return with(std::isfinite(goal.seconds_left) ? end - 1 : first);
}

std::optional<std::size_t> choose(const std::vector<Candidate>& candidates, const PlanGoal& goal) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    if (!c.reaches && (!std::isfinite(goal.seconds_left) || !(c.error < goal.error_now))) continue;
    if (!best) {
      best = i;
      continue;
    }
    const Candidate& b = candidates[*best];
    if (c.reaches != b.reaches ? c.reaches : c.reaches ? c.seconds < b.seconds : c.error < b.error) best = i;
  }
  return best;
}

}  // namespace grainlaw::chain
