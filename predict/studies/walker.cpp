#include "predict/studies/walker.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "model/vocabulary/error.hpp"
#include "predict/path_integration.hpp"
#include "predict/segment_law.hpp"
#include "predict/solvers/cvode.hpp"
#include "predict/solvers/dormand_prince.hpp"
#include "predict/solvers/runge_kutta.hpp"
#include "predict/studies/in_ranges.hpp"

namespace grainlaw::predict {
namespace {

constexpr double kAbsoluteShare = 1e-4;  // P* is some 1e-2

int order_of(Integrator integrator) {
  switch (integrator) {
    case Integrator::erk_2:
      return 2;
    case Integrator::erk_3:
      return 3;
    case Integrator::erk_4:
      return 4;
    case Integrator::erk_5:
      return 5;
    case Integrator::erk_6:
      return 6;
    case Integrator::erk_8:
      return 8;
    default:
      return 0;
  }
}

}  // namespace

struct Walker::Impl {
  const LawParameters<double>& parameters;
  Rung rung;
  Coupling coupling;
  double accuracy;
  long most_steps;
  std::optional<SegmentLaw> law;  // of the segment that is being walked
  std::optional<Cvode> cvode;
  std::optional<RungeKutta> runge_kutta;
  std::optional<DormandPrinceWork> dormand_prince;

  Arrival advance(Unknowns& y, double length) {
    if (dormand_prince)
      return integrate_dormand_prince(*law, y, length, {accuracy, kAbsoluteShare * accuracy, Method::adams, most_steps},
                                      *dormand_prince);
    if (runge_kutta) return runge_kutta->integrate(0, y, length);
    cvode->start(0, y, length);
    return cvode->advance(length, y);
  }

  /// Equal substeps of the segment; the number of them.
  long euler(const StraightSegment& segment, LawState<double>& state) const {
    const auto n = static_cast<long>(std::ceil(segment.length * segment.direction.tensor.norm() / accuracy));
    const double h = segment.length / static_cast<double>(n);
    const LawDirection direction = path_direction(Eigen::Matrix3d(segment.direction.tensor + segment.spin));
    for (long i = 0; i < n; ++i) {
      const double nu = segment.nu(h * static_cast<double>(i));
      turn_corner(rung, state, direction);
      state = moved(state, h, law_rate(parameters, rung, coupling, state, nu, direction));
    }
    return n;
  }

  /// The segment as predict() integrates it, through stretches where s_r follows s. Returns its statistics.
  SolverStatistics through_turns(const StraightSegment& segment, int index, LawState<double>& state) const {
    PathIntegration integration(parameters, rung, coupling, {state, {}, {}},
                                {accuracy, kAbsoluteShare * accuracy, Method::adams, most_steps});
    integration.enter(segment, index);
    integration.advance(segment.length);
    state = integration.state();
    return integration.statistics();
  }

  long rhs_evaluations() const {
    if (dormand_prince) return dormand_prince->rhs_evaluations;
    return runge_kutta ? runge_kutta->rhs_evaluations() : cvode ? cvode->statistics().rhs_evaluations : 0;
  }
  long steps() const {
    if (dormand_prince) return dormand_prince->steps;
    return runge_kutta ? runge_kutta->steps() : cvode ? cvode->statistics().steps : 0;
  }
};

Walker::Walker(Integrator integrator, double accuracy, const LawParameters<double>& parameters, Rung rung,
               Coupling coupling, long most_steps)
    : impl_(new Impl{parameters, rung, coupling, accuracy, most_steps, {}, {}, {}, {}}) {
  if (!(accuracy >= 1e-14 && accuracy < 1)) {
    throw InvalidInput(
        fmt::format("integrator {}: accuracy {} is outside [1e-14, 1)", to_string(integrator), accuracy));
  }
  const auto rate = [law = &impl_->law](double e, const double* y, double* out) { (*law)->rate(e, y, out); };
  const auto scale = [law = &impl_->law](double e, const double* y, double* out) { (*law)->scale(e, y, out); };
  if (integrator == Integrator::adams || integrator == Integrator::bdf) {
    const Method method = integrator == Integrator::adams ? Method::adams : Method::bdf;
    impl_->cvode.emplace(kUnknowns, Tolerances{accuracy, kAbsoluteShare * accuracy, method, most_steps}, rate,
                         OdeEvent{}, scale);
  } else if (integrator == Integrator::dopri_5) {
    impl_->dormand_prince.emplace();
  } else if (integrator != Integrator::euler) {
    impl_->runge_kutta.emplace(kUnknowns, order_of(integrator), accuracy, kAbsoluteShare * accuracy, most_steps, rate,
                               scale);
  }
}

Walker::~Walker() = default;

Walk Walker::walk(const std::vector<StraightSegment>& segments, const LawState<double>& start) {
  Impl& self = *impl_;
  Walk walk;
  walk.ends.reserve(segments.size());
  const long evaluations = self.rhs_evaluations(), steps = self.steps();
  LawState<double> state = start;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (!self.cvode && !self.runge_kutta && !self.dormand_prince) {
      walk.steps += self.euler(segments[k], state);
      walk.rhs_evaluations = walk.steps;
    } else {
      self.law.emplace(self.parameters, self.rung, self.coupling, segments[k], 0);
      turn_corner(self.rung, state, self.law->direction());
      Unknowns y = self.law->unknowns_of(0, state);
      const Arrival arrival = self.advance(y, segments[k].length);
      if (self.law->turned()) {  // also what may have made the solver fail
        const SolverStatistics again = self.through_turns(segments[k], static_cast<int>(k), state);
        walk.steps += again.steps;
        walk.rhs_evaluations += again.rhs_evaluations;
      } else if (arrival.kind != Arrival::Kind::reached) {
        throw NotConverged(fmt::format("segments[{}] at path parameter e = {:.9g} of {:.9g}: {}", k, arrival.t,
                                       segments[k].length, arrival.message));
      } else {
        state = self.law->state_of(segments[k].length, y.data());
      }
    }
    walk.ends.push_back(state);
  }
  walk.rhs_evaluations += self.rhs_evaluations() - evaluations;
  walk.steps += self.steps() - steps;
  return walk;
}

std::vector<LawState<double>> walk_batch(const std::vector<BatchPath>& paths, Integrator integrator, double accuracy,
                                         const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                                         int threads, const RunControl& control) {
  std::vector<LawState<double>> ends(paths.size());
  in_ranges(paths.size(), threads, [&](std::size_t first, std::size_t end) {
    Walker walker(integrator, accuracy, parameters, rung, coupling);
    for (std::size_t i = first; i < end; ++i) {
      if (control.stop.stop_requested()) throw Interrupted("the batch was interrupted");
      ends[i] = walker.walk(paths[i].segments, paths[i].start).ends.back();
    }
  });
  return ends;
}

}  // namespace grainlaw::predict
