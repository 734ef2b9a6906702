#include "predict/path_integration.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "model/vocabulary/error.hpp"

namespace grainlaw::predict {
namespace {

// Up to this strain one explicit Euler step is exact to rounding: its error is (beta e)^2/2 < 1e-22 for beta < 1e2..1e3.
// It keeps the solver away from intervals that it cannot resolve (zero, one ulp, denormal).
constexpr double kTinyStrain = 1e-13;

// P below this part of its start counts as zero: the stress ratio sigma'/P has no meaning there.
constexpr double kVanishedPressure = 1e-12;

// Below this part of its start P is held fixed in the rate, which goes like 1/P: trial steps look beyond P = 0.
constexpr double kHeldPressure = 1e-6;

// |sigma'|/P up to which no principal stress can be tensile: the least eigenvalue is at least -(2/3)|sigma'|.
constexpr double kSafeRatio = 1.2;

constexpr double kRounding = 1e-9;  // of a least principal stress that vanishes, over P; of <s - s_r, N> that does

constexpr int kMostEventsInPlace = 20;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Path parameter at which nu of `segment` falls to `nu_jamming`; infinite when its volume does not grow.
double jamming_point(const StraightSegment& segment, double nu_jamming) {
  const double dilation = segment.eps_vol_rate();
  if (!(dilation > 0)) return kInfinity;
  return std::log(segment.nu_start / nu_jamming) / dilation;
}

std::vector<double> magnitudes_of(const std::vector<ParameterStep>& steps) {
  std::vector<double> magnitudes;
  for (const ParameterStep& step : steps) magnitudes.push_back(step.magnitude);
  return magnitudes;
}

/// One after the other.
std::span<double> flat(std::vector<Slope>& slopes) {
  return slopes.empty() ? std::span<double>() : std::span(slopes.front().data(), kUnknowns * slopes.size());
}

void set_all(double& part, double value) { part = value; }
void set_all(Deviator<double>& part, double value) { part.setConstant(value); }

/// Of the state in steady shear at P.
void write_typical(double P, double* y) {
  LawState<double> typical;
  for_each_part([P](const StatePart& part, auto& of_y) { set_all(of_y, part.of_P ? part.typical * P : part.typical); },
                typical);
  pack(typical, y);
}

}  // namespace

double least_principal_stress(double P, const Deviator<double>& sigma) {
  const double norm = sigma.norm();
  if (norm <= kSafeRatio * P) return P - norm * (2.0 / 3.0);  // a bound will do there
  return P + Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor_of(sigma), Eigen::EigenvaluesOnly).eigenvalues()(0);
}

PathIntegration::PathIntegration(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                                 const PathStart& start, const Tolerances& tolerances)
    : parameters_(parameters),
      rung_(rung),
      coupling_(coupling),
      P_held_(kHeldPressure * start.state.P),
      P_floor_(kVanishedPressure * start.state.P),
      steps_(start.steps),
      solver_(
          kUnknowns, tolerances, [this](double e, const double* y, double* rate) { law_->rate(e, y, rate); },
          [this](double e, const double* y) { return event(e, y); },
          [this](double e, const double* y, double* scale) { law_->scale(e, y, scale); },
          {magnitudes_of(start.steps),
           [this](std::size_t k, double e, const double* y, const double* s, double* rate) {
             sensitivity_->rate(k, e, y, s, rate);
           },
           [this](double* y) { write_typical(state_.P, y); }}),
      state_(start.state) {
  for (const LawState<double>& slope : start.slopes) slopes_.push_back(packed(slope));
}

std::vector<LawState<double>> PathIntegration::slopes() const {
  std::vector<LawState<double>> slopes;
  for (const Slope& slope : slopes_) slopes.push_back(unpacked(slope.data()));
  slopes.resize(steps_.size(), unknown_slope());
  return slopes;
}

/// Falls through zero where the state unjams, or s_r begins or ends to follow s.
double PathIntegration::event(double e, const double* y) const {
  const LawState<double> state = law_->state_of(e, y);
  double least = std::min(state.P - P_floor_, least_principal_stress(state.P, state.sigma));
  if (rung_ != Rung::memory || law_->direction().de == 0 || !(state.P > P_floor_)) return least;
  return std::min(least, follows_ ? -law_->reversal_rate(e, state) : reversal_value(state, law_->direction()));
}

void PathIntegration::note(EventKind kind) { events_.push_back({kind, {index_, e_}, law_->segment().nu(e_)}); }

/// The solver's next run begins at e_ with `state`.
void PathIntegration::start_from(const LawState<double>& state) {
  state_ = state;
  at_start_ = law_->unknowns_of(e_, state);
  slopes_at_start_.clear();
  for (std::size_t k = 0; k < slopes_.size(); ++k)
    slopes_at_start_.push_back(sensitivity_->of_unknowns(k, e_, state, slopes_[k]));
  e_start_ = e_;
  started_ = false;
}

void PathIntegration::enter(const StraightSegment& segment, int index) {
  law_.emplace(parameters_, rung_, coupling_, segment, P_held_);
  sensitivity_.emplace(steps_, rung_, coupling_, segment, P_held_);
  index_ = index;
  e_ = 0;
  events_in_place_ = 0;
  jammed_until_ = rung_ == Rung::memory ? kInfinity : jamming_point(segment, parameters_.isotropic.pressure.nu_c);
  follows_ = false;
  if (jammed_) turn();
}

/// At a corner, or where s_r begins or ends to follow s: from there on as the state asks for.
void PathIntegration::turn() {
  const LawDirection& direction = law_->direction();
  const bool turned = rung_ == Rung::memory && direction.de > 0 && reversal_value(state_, direction) <= kRounding;
  const bool followed = std::exchange(follows_, turned && !follows_ && law_->reversal_rate(e_, state_) < 0);
  if (turned && (follows_ || followed || reversal_value(state_, direction) < 0)) {
    for (Slope& slope : slopes_) slope = turned_slope(state_, slope, direction);
    reverse(state_, direction);
  }
  law_->set(follows_ ? Turning::follows : Turning::rests);
  sensitivity_->set(follows_ ? Turning::follows : Turning::rests);
  start_from(state_);
}

void PathIntegration::advance(double e) {
  while (e_ < e) {
    if (!jammed_)
      move_unjammed(e);
    else
      move_jammed(e);
  }
}

/// Path parameter at which nu rises to nu_J: there the state jams again.
void PathIntegration::move_unjammed(double e) {
  const StraightSegment& segment = law_->segment();
  const double dx = law_->direction().dx;
  const double e_J = dx > 0 ? std::max(std::log(nu_J_ / segment.nu_start) / dx, e_) : kInfinity;
  if (!(e_J < e)) {
    e_ = e;
    return;
  }
  e_ = e_J;
  jammed_ = true;
  note(EventKind::jammed);
  state_ = {.P = 2 * P_floor_};
  turn();
}

void PathIntegration::move_jammed(double e) {
  const StraightSegment& segment = law_->segment();
  const double target = std::min(e, jammed_until_);
  if (target <= e_) {  // at the jamming density already
    take_event();
    return;
  }
  Unknowns y = at_start_;
  std::vector<Slope> slopes = slopes_at_start_;
  bool fallen = false;
  if ((target - e_start_) * (segment.direction.tensor + segment.spin).norm() <= kTinyStrain) {
    Unknowns slope;
    law_->rate(e_start_, y.data(), slope.data());
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      Slope rate;
      sensitivity_->rate(k, e_start_, y.data(), slopes[k].data(), rate.data());
      for (std::size_t i = 0; i < kUnknowns; ++i) slopes[k][i] += (target - e_start_) * rate[i];
    }
    for (std::size_t i = 0; i < kUnknowns; ++i) y[i] += (target - e_start_) * slope[i];
    e_ = target;
  } else {
    if (!started_) solver_.start(e_start_, y, std::min(segment.length, jammed_until_), flat(slopes));
    started_ = true;
    const Arrival arrival = solver_.advance(target, y);
    // close to jamming slopes are endless, the law is not
    if (arrival.kind == Arrival::Kind::failed && !slopes_.empty()) {
      slopes_.clear();
      start_from(state_);
      return;
    }
    if (arrival.kind == Arrival::Kind::failed) {
      throw NotConverged(
          fmt::format("segments[{}] at path parameter e = {:.9g} of {:.9g}, nu = {:.9g}: {}; end the segment before "
                      "that, or take another rung",
                      index_, arrival.t, segment.length, segment.nu(arrival.t), arrival.message));
    }
    if (arrival.t > e_) events_in_place_ = 0;
    e_ = arrival.t;
    solver_.sensitivities(flat(slopes));
    fallen = arrival.kind == Arrival::Kind::event;
  }
  state_ = law_->state_of(e_, y.data());
  for (std::size_t k = 0; k < slopes.size(); ++k) slopes_[k] = sensitivity_->of_state(k, e_, y, slopes[k]);
  if (fallen || e_ >= jammed_until_ || state_.P <= P_floor_) take_event();
}

/// Where event() has come to zero or nu to the jamming density.
void PathIntegration::take_event() {
  if (++events_in_place_ > kMostEventsInPlace) {
    throw NotConverged(
        fmt::format("segments[{}] at path parameter e = {:.9g}, nu = {:.9g}: events follow each other "
                    "without end; end the segment before that, or take another rung",
                    index_, e_, law_->segment().nu(e_)));
  }
  // the root is found to rounding, on either side
  const bool vanished = e_ >= jammed_until_ || state_.P <= 2 * P_floor_;
  if (vanished || least_principal_stress(state_.P, state_.sigma) <= kRounding * state_.P) {
    note(vanished ? EventKind::unjammed : EventKind::tension);
    jammed_ = false;
    slopes_.clear();
    nu_J_ = law_->segment().nu(e_);
    state_ = {};
    return;
  }
  turn();
}

WalkedPath walk_integrated(const LawParameters<double>& parameters, Rung rung, Coupling coupling,
                           const std::vector<StraightSegment>& segments, const PathStart& start,
                           const std::vector<OutputPoint>& points, const Tolerances& tolerances,
                           const RunControl& control, const PathVisitor& visit) {
  PathIntegration integration(parameters, rung, coupling, start, tolerances);
  WalkedPath out = walk(integration, segments, points, control, visit);
  out.statistics = integration.statistics();
  return out;
}

}  // namespace grainlaw::predict
