#include "predict/predict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"
#include "predict/path_walk.hpp"

namespace grainlaw::predict {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void check_tolerances(const Tolerances& tolerances) {
  if (!(tolerances.relative >= 1e-14 && tolerances.relative < 1)) {
    throw InvalidInput(fmt::format("relative tolerance {} is outside [1e-14, 1)", tolerances.relative));
  }
  if (!(tolerances.absolute >= 0 && std::isfinite(tolerances.absolute))) {
    throw InvalidInput(fmt::format("absolute tolerance {} is not a positive number", tolerances.absolute));
  }
  if (tolerances.max_steps < 1) throw InvalidInput(fmt::format("max_steps {} is not positive", tolerances.max_steps));
}

void check_path(const std::vector<StraightSegment>& segments, const std::vector<OutputPoint>& points) {
  if (segments.empty()) throw InvalidInput("the path has no segments; give at least one");
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const StraightSegment& s = segments[k];
    if (!(s.length >= 0 && std::isfinite(s.length) && s.direction.tensor.allFinite() && std::isfinite(s.nu_start) &&
          s.strain_start.tensor.allFinite())) {
      throw InvalidInput(fmt::format("segments[{}] is not finite or has a negative length", k));
    }
  }
  OutputPoint before;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const OutputPoint& point = points[i];
    if (point.segment < before.segment || point.segment >= static_cast<int>(segments.size())) {
      throw InvalidInput(
          fmt::format("output point {}: segment {} is not one of {} in order", i, point.segment, segments.size()));
    }
    const double length = segments[static_cast<std::size_t>(point.segment)].length;
    const double from = point.segment == before.segment ? before.e : 0;
    if (!(point.e >= from && point.e <= length)) {
      throw InvalidInput(fmt::format("output point {}: e = {} is outside [{}, {}] of segment {}", i, point.e, from,
                                     length, point.segment));
    }
    before = point;
  }
}

/// In the reduced model, nothing but the fabric depends on it.
bool is_defined(const LawState<double>& state, Rung model) {
  return model == Rung::reduced ? std::isfinite(state.P) && state.sigma.allFinite() : as_vector(state).allFinite();
}

void check_start(const LawParameters<double>& parameters, double nu, const LawState<double>& start, Rung model) {
  if (model != Rung::reduced && start.F.array().isNaN().all())
    throw InvalidInput(
        fmt::format("the start tells no fabric, which the {} law starts from; start from the law's own values, or ask "
                    "the reduced law",
                    to_string(model)));
  for_each_part(
      [&](const StatePart& part, const auto& of_start) {
        if (!numbers(of_start).allFinite() && !is_defined(start, model))
          throw InvalidInput(fmt::format("the state at the start of the prediction is not finite in {}", part.name));
      },
      start);
  const double nu_c = parameters.isotropic.pressure.nu_c;
  if (!(nu > nu_c)) {
    throw InvalidInput(fmt::format(
        "the start is not jammed: nu = {:.9g} is not above the law's pressure.nu_c = {:.9g}; start denser", nu, nu_c));
  }
  if (!(start.P > 0)) {
    throw InvalidInput(
        fmt::format("the start is not jammed: P_star = {} at nu = {:.9g} is not positive; check the "
                    "parameters of the pressure, or start denser",
                    start.P + 0.0, nu));
  }
}

RowSlope slope_of(const LawState<double>& state, const LawState<double>& slope, const Deviator<double>& N) {
  const auto norm_slope = [](const Deviator<double>& a, const Deviator<double>& b) {
    const double norm = a.norm();
    return norm > 0 ? a.dot(b) / norm : b.norm();  // of a norm that leaves zero
  };
  RowSlope row;
  row.state = slope;
  row.s_dev = (norm_slope(state.sigma, slope.sigma) - state.sigma.norm() / state.P * slope.P) / state.P;
  row.F_dev = norm_slope(state.F, slope.F);
  const bool sheared = !N.isZero();
  row.s_par = sheared ? (slope.sigma - state.sigma * (slope.P / state.P)).dot(N) / state.P : kNaN;
  row.F_par = sheared ? slope.F.dot(N) : kNaN;
  return row;
}

/// One line for each way in which `rows` leave `range`, naming the farthest row, and for the first event of a kind.
std::vector<std::string> warnings_of(const std::vector<PredictedRow>& rows, const std::vector<PathEvent>& events,
                                     const ValidRange& range) {
  constexpr double slack = 1e-9;  // rounding of a path that ends at the limit
  double nu_low = range.nu_min, nu_high = range.nu_max, eps_dev = 0, eps_vol = 0, shear_path = 0;
  for (const PredictedRow& row : rows) {
    nu_low = std::min(nu_low, row.nu);
    nu_high = std::max(nu_high, row.nu);
    eps_dev = std::max(eps_dev, row.eps_dev);
    eps_vol = std::max(eps_vol, std::abs(row.eps_vol));
    shear_path = std::max(shear_path, row.shear_path);
  }
  std::vector<std::string> warnings;
  for (const double nu : {nu_low, nu_high}) {
    if (nu < range.nu_min - slack || nu > range.nu_max + slack) {
      warnings.push_back(
          fmt::format("nu = {:.4g} lies outside the calibrated range {:.4g}-{:.4g}", nu, range.nu_min, range.nu_max));
    }
  }
  if (eps_dev > range.eps_dev_max + slack) {
    warnings.push_back(
        fmt::format("eps_dev = {:.4g} lies beyond the calibrated strain {:.4g}", eps_dev, range.eps_dev_max));
  }
  if (eps_vol > range.eps_vol_max + slack) {
    warnings.push_back(fmt::format("|eps_vol| = {:.4g} lies beyond the calibrated volumetric strain {:.4g}", eps_vol,
                                   range.eps_vol_max));
  }
  if (shear_path > range.shear_path_max + slack) {
    warnings.push_back(
        fmt::format("shear_path = {:.4g} is longer than the calibrated {:.4g}", shear_path, range.shear_path_max));
  }
  const auto first = [&](EventKind kind, const char* what) {
    const auto event = std::find_if(events.begin(), events.end(), [&](const PathEvent& e) { return e.kind == kind; });
    if (event == events.end()) return;
    warnings.push_back(fmt::format("segments[{}] at nu = {:.4g}: {}", event->at.segment, event->nu, what));
  };
  first(EventKind::unjammed, "the state unjams; P, stress and fabric are zero until nu rises above that again");
  first(EventKind::tension,
        "a principal stress vanishes and the state unjams: grains without cohesion carry no tension; P, stress and "
        "fabric are zero until nu rises above that again");
  return warnings;
}

PathStart start_of(const LawParameters<double>& parameters, double nu, const LawState<double>& start,
                   const Sensitivity& sensitivity) {
  PathStart result{start, parameter_steps(parameters, sensitivity.parameters), {}};
  for (const ParameterStep& step : result.steps) {
    LawState<double> slope;
    if (sensitivity.start_from_law)
      slope.P = (step.above.isotropic.P_star(nu) - step.below.isotropic.P_star(nu)) / (2 * step.h);
    result.slopes.push_back(slope);
  }
  return result;
}

}  // namespace

LawState<double> unknown_slope() {
  LawState<double> slope;
  as_vector(slope).setConstant(kNaN);
  return slope;
}

PredictedRow row_of(const PathPlace& place, const LawState<double>& state, const Deviator<double>& N) {
  PredictedRow row;
  row.segment = place.segment;
  set_strain(row, place.strain);
  row.shear_path = place.shear_path;
  row.nu = place.nu;
  row.state = state;
  set_ratios(row, state.P, state.sigma, state.F, N);
  return row;
}

void conclude(Prediction& prediction, const ValidRange& range, std::chrono::steady_clock::time_point begun) {
  const auto first =
      std::ranges::find_if(prediction.events, [](const PathEvent& event) { return event.kind != EventKind::jammed; });
  prediction.unjammed = first != prediction.events.end();
  if (prediction.unjammed) prediction.unjammed_at = first->at;
  prediction.warnings = warnings_of(prediction.rows, prediction.events, range);
  prediction.statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

LawState<double> state_from_law(const LawParameters<double>& parameters, double nu) {
  const LawState<double> state{.P = parameters.isotropic.P_star(nu)};
  check_start(parameters, nu, state, Rung::reduced);
  return state;
}

LawState<double> state_from_row(const Observation& row) {
  const double P = row.stress.tensor.trace() / 3;
  if (!(P > 0 && row.P_star > 0)) {
    throw InvalidInput(
        fmt::format("the measured start is not jammed: P_star = {} ({} Pa) at nu = {:.9g} is not positive; "
                    "start from the law's own values, or where the packing is jammed",
                    row.P_star + 0.0, P + 0.0, row.nu));
  }
  const LawState<double> state{row.P_star, deviator<double>(row.stress.tensor) * (row.P_star / P),
                               deviator<double>(row.fabric.tensor)};
  if (!is_defined(state, Rung::reduced) || !(state.F.allFinite() || row.fabric.tensor.array().isNaN().all()))
    throw InvalidInput("the measured start has a stress or fabric that is not finite");
  return state;
}

Prediction predict(Rung model, const LawParameters<double>& parameters, Coupling coupling,
                   const std::vector<StraightSegment>& segments, const LawState<double>& start,
                   const std::vector<OutputPoint>& points, const Tolerances& tolerances, const ValidRange& range,
                   const RunControl& control, const Sensitivity& sensitivity) {
  check_tolerances(tolerances);
  check_path(segments, points);
  check_start(parameters, segments.front().nu_start, start, model);

  const auto before = std::chrono::steady_clock::now();
  const PathStart from = start_of(parameters, segments.front().nu_start, start, sensitivity);

  Prediction prediction;
  prediction.model = model;
  const Deviator<double> N = shear_direction(segments);
  prediction.rows.reserve(points.size());
  std::size_t k = 0;
  double path_before = 0;  // shear path at the start of segment k
  const auto add_row = [&](const LawState<double>& state, const std::vector<LawState<double>>& state_slopes) {
    const auto& [index, e] = points[prediction.rows.size()];
    for (; k < static_cast<std::size_t>(index); ++k) path_before += segments[k].eps_dev_rate() * segments[k].length;
    const StraightSegment& segment = segments[k];
    if (!is_defined(state, model) || !(state.P >= 0)) {
      throw Error(
          fmt::format("segments[{}] at e = {:.9g}: the {} law gives a state that is not finite or P* < 0; "
                      "check the parameters",
                      k, e, to_string(model)));
    }
    const PathPlace place{index, segment.strain(e), path_before + segment.eps_dev_rate() * e, segment.nu(e)};
    prediction.rows.push_back(row_of(place, state, N));
    if (state_slopes.empty() || !sensitivity.use) return;
    std::vector<RowSlope> slopes;
    slopes.reserve(state_slopes.size());
    for (const LawState<double>& slope : state_slopes) slopes.push_back(slope_of(state, slope, N));
    sensitivity.use(prediction.rows.back(), slopes);
  };
  const WalkedPath path = model == Rung::reduced ? walk_reduced(parameters, segments, from, points, control, add_row)
                                                 : walk_integrated(parameters, model, coupling, segments, from, points,
                                                                   tolerances, control, add_row);
  prediction.events = path.events;
  prediction.statistics = path.statistics;
  conclude(prediction, range, before);
  return prediction;
}

}  // namespace grainlaw::predict
