#include "predict/studies/work_precision.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"
#include "predict/predict.hpp"

namespace grainlaw::predict {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kReferenceTolerance = 1e-13;
constexpr double kSecondsPerPoint = 0.5;  // after which no more repeats are begun

PathSegment leg(Mode mode, ExtentKind kind, double extent, bool reverse = false) {
  return {mode, direction_of(mode, "xyz", reverse), kind, extent};
}

StudyPath study_path(const LawParameters<double>& parameters, double nu, std::vector<PathSegment> segments) {
  StudyPath path;
  path.segments = resolve({nu, Branch::unloading, std::move(segments)});
  path.start = state_from_law(parameters, nu);
  return path;
}

double error_of(const Walk& walk, const Walk& reference) {
  double error = 0;
  for (std::size_t k = 0; k < reference.ends.size(); ++k) {
    const LawState<double>&a = walk.ends.at(k), &b = reference.ends[k];
    const double here = std::max({std::abs(a.P / b.P - 1), (a.sigma - b.sigma).norm() / b.P, (a.F - b.F).norm()});
    if (!(here <= error)) error = here;  // a NaN stays
  }
  return error;
}

/// Decades of tolerance; of euler half decades of substeps.
std::vector<double> accuracies(Integrator integrator) {
  std::vector<double> result;
  if (integrator == Integrator::euler) {
    for (int i = 4; i <= 11; ++i) result.push_back(std::pow(10.0, -i / 2.0));
  } else {
    const int last = integrator == Integrator::erk_2 || integrator == Integrator::erk_3 ? 8 : 12;
    for (int i = 3; i <= last; ++i) result.push_back(std::pow(10.0, -i));
  }
  return result;
}

WorkPoint measure(const StudyPath& path, Walker& walker, const Walk& reference, int repeats) {
  WorkPoint point;
  point.microseconds = std::numeric_limits<double>::infinity();
  const auto begin = Clock::now();
  for (int i = 0; i < repeats; ++i) {
    const auto before = Clock::now();
    const Walk walk = walker.walk(path.segments, path.start);
    const auto after = Clock::now();
    point.microseconds =
        std::min(point.microseconds, std::chrono::duration<double, std::micro>(after - before).count());
    point.error = error_of(walk, reference);
    point.rhs_evaluations = walk.rhs_evaluations;
    point.steps = walk.steps;
    if (std::chrono::duration<double>(after - begin).count() > kSecondsPerPoint) break;
  }
  return point;
}

}  // namespace

std::vector<StudyPath> study_paths(const LawParameters<double>& parameters) {
  StudyPath smooth = study_path(parameters, 0.695, {leg(Mode::UNI, ExtentKind::target_nu, 0.82)});
  smooth.name = "smooth";
  smooth.description = "UNI from nu = 0.695 to 0.82";
  constexpr double amplitude = 0.05;
  StudyPath reversal = study_path(
      parameters, 0.70,
      {leg(Mode::D2, ExtentKind::eps_dev, amplitude), leg(Mode::D2, ExtentKind::eps_dev, 2 * amplitude, true),
       leg(Mode::D2, ExtentKind::eps_dev, 2 * amplitude), leg(Mode::D2, ExtentKind::eps_dev, 2 * amplitude, true),
       leg(Mode::D2, ExtentKind::eps_dev, amplitude)});
  reversal.name = "reversal";
  reversal.description = "two cycles of D2 between eps_dev = +-0.05 at nu = 0.70";
  const double just_jammed = parameters.isotropic.pressure.nu_c * 1.002;
  StudyPath near_unjamming =
      study_path(parameters, 0.70,
                 {leg(Mode::ISO, ExtentKind::target_nu, just_jammed, true), leg(Mode::D2, ExtentKind::eps_dev, 0.1)});
  near_unjamming.name = "near-unjamming";
  near_unjamming.description = "ISO unloading from nu = 0.70 to 1.002 nu_c, then D2 to eps_dev = 0.1";
  return {smooth, reversal, near_unjamming};
}

WorkPrecision measure_work(const StudyPath& path, const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                           int repeats, const RunControl& control) {
  WorkPrecision study;
  study.path = path;
  const auto tight = [&](Integrator integrator) {
    return Walker(integrator, kReferenceTolerance, parameters, rung, coupling).walk(path.segments, path.start);
  };
  const Walk reference = tight(Integrator::erk_8);
  study.end = reference.ends.back();
  study.reference_disagreement = error_of(tight(Integrator::adams), reference);
  for (const Integrator integrator : kIntegrators) {
    for (const double accuracy : accuracies(integrator)) {
      if (control.stop.stop_requested()) throw Interrupted("the study was interrupted");
      Walker walker(integrator, accuracy, parameters, rung, coupling);
      WorkPoint point = measure(path, walker, reference, repeats);
      point.integrator = integrator;
      point.accuracy = accuracy;
      study.points.push_back(point);
    }
  }
  return study;
}

const WorkPoint* quickest(const WorkPrecision& study, double error, const Integrator* integrator) {
  const WorkPoint* best = nullptr;
  for (const WorkPoint& point : study.points) {
    if (integrator ? point.integrator != *integrator : point.integrator == Integrator::euler) continue;
    if (point.error <= error && (!best || point.microseconds < best->microseconds)) best = &point;
  }
  return best;
}

}  // namespace grainlaw::predict
