#include "app/precision_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "app/uncertainty.hpp"
#include "model/error.hpp"
#include "model/student.hpp"
#include "predict/predict.hpp"

namespace grainlaw::app {
namespace {

constexpr int kPointsPerSegment = 100;
constexpr int kLeastPackings = 3;    // two say nearly nothing of their scatter: t = 12.7
constexpr int kMostPackings = 1000;  // as many as a SPEC has seeds
constexpr int kGrowth = 3;           // at most so many times the packings in one round: few know their own error badly
constexpr double kSlack = 1.05;      // packings beyond those needed by the estimate, which is itself uncertain

Rung richest(const fit::Calibration& c) {
  if (fit::has_values(c, "memory")) return Rung::memory;
  const char* coupling = c.coupling == Coupling::energy ? "anisotropy.a2" : "anisotropy.a0";
  return c.estimates[parameter_index(coupling)].status != fit::Status::not_identified ? Rung::evolution : Rung::reduced;
}

/// Name of a test without its seed: runs of one path on several packings.
std::string path_name(const std::string& test) { return test.substr(0, test.rfind("-s")); }

double discrepancy_of(const fit::Calibration& c, Rung rung) {
  struct Bias {
    double sum = 0, largest = 0;
    int packings = 0;
  };
  std::map<std::string, std::map<std::string, Bias>> biases;  // by quantity and path
  for (const fit::Stage& stage : c.stages) {
    if (stage.name != to_string(rung)) continue;
    for (const fit::TestResidual& r : stage.tests) {
      if (!r.in_cost || r.rows == 0) continue;
      Bias& bias = biases[r.quantity][path_name(r.test)];
      bias.sum += r.bias;
      bias.largest = std::max(bias.largest, r.max_abs_data);
      ++bias.packings;
    }
  }
  double worst = 0;
  for (const auto& [quantity, paths] : biases) {
    double squares = 0;
    for (const auto& [path, bias] : paths) {
      const double relative = bias.sum / bias.packings / bias.largest;
      squares += relative * relative;
    }
    worst = std::max(worst, std::sqrt(squares / static_cast<double>(paths.size())));
  }
  return worst;
}

void add_packings(Spec& spec, int wanted) {
  std::uint64_t next = *std::max_element(spec.seeds.begin(), spec.seeds.end());
  while (static_cast<int>(spec.seeds.size()) < wanted) spec.seeds.push_back(++next);
}

}  // namespace

PredictionError prediction_error(const fit::Calibration& c, const Path& path) {
  PredictionError error;
  error.rung = richest(c);
  error.discrepancy = discrepancy_of(c, error.rung);
  error.half_width = std::numeric_limits<double>::quiet_NaN();
  const predict::Uncertainty uncertainty = uncertainty_of(c);
  const auto segments = resolve(path);
  predict::Prediction prediction = predict::predict(
      error.rung, c.parameters, c.coupling, segments, predict::state_from_law(c.parameters, path.nu),
      predict::uniform_points(segments, kPointsPerSegment), {}, {}, {}, {uncertainty.parameters, true});
  predict::add_bands(c.parameters, uncertainty, prediction);
  const auto judge = [&](const char* quantity, auto value, double predict::RowBand::*band) {
    double largest = 0, width = std::numeric_limits<double>::quiet_NaN();
    for (const predict::PredictedRow& row : prediction.rows) {
      if (std::isfinite(value(row))) largest = std::max(largest, std::abs(value(row)));
      if (std::isfinite(row.mean.*band)) width = std::fmax(width, row.mean.*band);
    }
    if (!(largest > 0) || !std::isfinite(width) || width / largest <= error.half_width) return;
    error.half_width = width / largest;
    error.quantity = quantity;
  };
  judge(
      "P_star", [](const auto& row) { return row.state.P; }, &predict::RowBand::P);
  judge(
      "s_par", [](const auto& row) { return row.s_par; }, &predict::RowBand::s_par);
  judge(
      "F_par", [](const auto& row) { return row.F_par; }, &predict::RowBand::F_par);
  return error;
}

int packings_needed(double half_width, int packings, double target) {
  const auto factor = [](int n) { return student_95(n - 1) / std::sqrt(n); };
  int n = 2;
  while (n < kMostPackings && half_width * factor(n) / factor(packings) > target) ++n;
  return n;
}

std::string to_string(PlanOutcome outcome) {
  switch (outcome) {
    case PlanOutcome::met:
      return "met";
    case PlanOutcome::discrepancy:
      return "the law's own discrepancy is larger than the target";
    case PlanOutcome::max_cost:
      return "the allowed time ended";
    case PlanOutcome::no_band:
      break;
  }
  return "the prediction has no band";
}

PrecisionPlan reach(const PrecisionTarget& target, Spec spec,
                    const std::function<fit::Calibration(const Spec&)>& calibrate_with,
                    const std::function<double()>& seconds, const std::function<void(const std::string&)>& log) {
  add_packings(spec, kLeastPackings);
  PrecisionPlan plan;
  while (true) {
    const int packings = static_cast<int>(spec.seeds.size());
    log(fmt::format("round {}: {} packings of {} spheres", plan.rounds.size() + 1, packings,
                    spec.preparation.packing.particles));
    const fit::Calibration calibration = calibrate_with(spec);
    plan.rounds.push_back({packings, seconds(), prediction_error(calibration, target.path)});
    const PlanRound& last = plan.rounds.back();
    const auto ended = [&](PlanOutcome outcome) {
      plan.outcome = outcome;
      return plan;
    };
    if (!std::isfinite(last.error.half_width)) return ended(PlanOutcome::no_band);
    log(fmt::format(
        "the {} rung knows {} to {:.2f} % with {} packings after {:.0f} s; wanted {:.2f} %; what the fit leaves "
        "over is {:.2f} %",
        to_string(last.error.rung), last.error.quantity, 100 * last.error.half_width, packings, last.seconds,
        100 * target.error, 100 * last.error.discrepancy));
    if (last.error.half_width <= target.error) {
      return ended(last.error.discrepancy <= target.error ? PlanOutcome::met : PlanOutcome::discrepancy);
    }
    if (last.error.discrepancy > target.error) return ended(PlanOutcome::discrepancy);
    int wanted = packings_needed(last.error.half_width, packings, target.error);
    wanted = std::clamp(static_cast<int>(std::ceil(kSlack * wanted)), packings + 1, kGrowth * packings);
    if (target.max_seconds > 0) {
      const double per_packing = last.seconds / packings;
      wanted = std::min(wanted, packings + static_cast<int>((target.max_seconds - last.seconds) / per_packing));
    }
    if (wanted <= packings || packings >= kMostPackings) return ended(PlanOutcome::max_cost);
    log(fmt::format("next: {} packings, about {:.0f} s more", wanted, (wanted - packings) * last.seconds / packings));
    add_packings(spec, std::min(wanted, kMostPackings));
  }
}

}  // namespace grainlaw::app
