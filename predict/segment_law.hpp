#pragma once
// Eq. (16), with or without memory, on a straight segment in the unknowns that are integrated. Its volumetric terms are
// total differentials, B dx = dP(nu) with P(nu) of Eq. (14), and need no integration where F' stays:
//   y = (Pi, tau, and the rest of the state),   P = P(nu) + Pi,   sigma' = tau + g F'
//   g = a2 P(nu) (Coupling::energy, memory) or (a0/3) ln(nu/nu_start) (Coupling::single), so that dg = (A2/F') dx
//   dPi = A1 S de,   dtau = DG (N - sigma'/(P s_max)) de - g dF',   the rest as it is
// Memory's B is that at its own jamming density, and what it differs by from P(nu)'s stays in dPi and dtau.
// Without it an error made where P is large is carried down to where it is small: from nu = 0.82 to 0.67 it grows 54 times.

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include "model/law.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::predict {

inline constexpr std::size_t kUnknowns = kStateSize;
using Unknowns = std::array<double, kUnknowns>;

/// The numbers of a part of a state.
inline auto numbers(double& part) { return Eigen::Map<Eigen::Matrix<double, 1, 1>>(&part); }
inline auto numbers(const double& part) { return Eigen::Map<const Eigen::Matrix<double, 1, 1>>(&part); }
inline Deviator<double>& numbers(Deviator<double>& part) { return part; }
inline const Deviator<double>& numbers(const Deviator<double>& part) { return part; }

/// Writes `of` the numbers of each part, by default as they stand. Part by part: reading in other portions than were written makes a processor wait.
template <class Of = std::identity>
GRAINLAW_FLATTEN void pack(const LawState<double>& state, double* y, const Of& of = {}) {
  for_each_part(
      [&](const StatePart&, const auto& part) {
        const auto& from = numbers(part);
        Eigen::Map<typename std::decay_t<decltype(from)>::PlainObject> to(y);
        to = of(from);
        y += from.size();
      },
      state);
}
inline Unknowns packed(const LawState<double>& state) {
  Unknowns y;
  pack(state, y.data());
  return y;
}
GRAINLAW_FLATTEN inline LawState<double> unpacked(const double* y) {
  LawState<double> state;
  for_each_part(
      [&y](const StatePart&, auto& part) {
        auto&& to = numbers(part);
        to = Eigen::Map<const typename std::decay_t<decltype(to)>::PlainObject>(y);
        y += to.size();
      },
      state);
  return state;
}

/// What s_r does along N on a segment (model/law.hpp): stays, or follows s.
enum class Turning { rests, follows };

/// The law on one segment, continued harmlessly past the end of the jammed range, where trial steps of a solver look.
class SegmentLaw {
 public:
  /// Below `P_held` the rate is that at `P_held`. The arguments must outlive the object.
  SegmentLaw(const LawParameters<double>& parameters, Rung rung, Coupling coupling, const StraightSegment& segment,
             double P_held)
      : p_(&parameters),
        rung_(rung),
        coupling_(coupling),
        segment_(&segment),
        direction_(path_direction(Eigen::Matrix3d(segment.direction.tensor + segment.spin))),
        P_held_(P_held) {}

  /// Turning::rests before the first call.
  void set(Turning turning) { turning_ = turning; }

  /// Whether shear had turned in any state that a rate was asked for, s_r at rest; also in trial steps of a solver.
  bool turned() const { return least_reversal_ < -kTurned; }

  const StraightSegment& segment() const { return *segment_; }
  const LawDirection& direction() const { return direction_; }

  Unknowns unknowns_of(double e, LawState<double> state) const {
    const Place& here = at(e);
    state.P -= here.P_ref;
    state.sigma -= here.g * state.F;
    return packed(state);
  }

  LawState<double> state_of(double e, const double* y) const {
    const Place& here = at(e);
    LawState<double> state = unpacked(y);
    state.P += here.P_ref;
    state.sigma += here.g * state.F;
    return state;
  }

  /// d(state)/de.
  LawState<double> state_rate(double e, const LawState<double>& state) const {
    const LawState<double> held = this->held(state);
    const LawModuli<double>& m = at(e).moduli;
    if (turning_ == Turning::follows) return following_rate(m, *p_, held, direction_);
    if (rung_ == Rung::memory) least_reversal_ = std::min(least_reversal_, grainlaw::reversal_value(held, direction_));
    return law_rate(m, *p_, rung_, coupling_, held, direction_);
  }

  /// Rate of <s - s_r, N> of the turned state with s_r at rest.
  double reversal_rate(double e, const LawState<double>& state) const {
    LawState<double> turned = held(state);
    reverse(turned, direction_);
    return grainlaw::reversal_rate(turned, law_rate(at(e).moduli, *p_, rung_, coupling_, turned, direction_),
                                   direction_);
  }

  /// dy/de, into `out`. Flattened: left to themselves, compilers call the parts of the law, which takes a tenth longer.
  GRAINLAW_FLATTEN void rate(double e, const double* y, double* out) const {
    const LawState<double> state = state_of(e, y);
    const LawState<double> rate = state_rate(e, state);
    const Place& here = at(e);
    const LawModuli<double>& m = here.moduli;
    const double dg = single() ? p_->anisotropy.a0 / 3.0 : a2() * m.B;
    pack(rate, out);
    out[0] -= m.B * direction_.dx;
    Eigen::Map<Deviator<double>> dtau(out + 1);
    dtau = rate.sigma - state.F * (dg * direction_.dx) - here.g * rate.F;
  }

  /// What a relative tolerance refers to: P, sigma', F', not the differences that stand for them.
  void scale(double e, const double* y, double* out) const {
    pack(state_of(e, y), out, [](const auto& part) { return part.cwiseAbs(); });
  }

 private:
  static constexpr double kTurned = 1e-12;

  /// What depends on the path parameter alone: the expensive part of a rate, and the same for all that a solver asks
  /// at one place (rate, weights, events), hence kept. One object serves one thread.
  struct Place {
    double e = std::numeric_limits<double>::quiet_NaN();
    double P_ref = 0, g = 0;
    LawModuli<double> moduli{};
  };

  LawState<double> held(LawState<double> state) const {
    state.P = std::max(state.P, P_held_);
    return state;
  }

  bool single() const { return rung_ == Rung::evolution && coupling_ == Coupling::single; }
  double a2() const { return rung_ == Rung::memory ? p_->memory.a2 : p_->anisotropy.a2; }

  const Place& at(double e) const {
    if (e == place_.e) return place_;
    place_.e = e;
    const double nu = segment_->nu_start * std::exp(direction_.dx * e);
    if (rung_ == Rung::memory) {
      place_.moduli = law_moduli(*p_, nu, rung_);
      place_.P_ref = place_.moduli.P_iso;
    } else {
      // Eq. (16) ends at the jamming density: B jumps to zero there, and just above it is the limit of the jammed side.
      const double jammed = p_->isotropic.pressure.nu_c * (1 + 4 * std::numeric_limits<double>::epsilon());
      place_.moduli = law_moduli(*p_, std::max(nu, jammed), rung_);
      place_.P_ref = nu > jammed ? place_.moduli.P_iso : 0;
    }
    place_.g = single() ? p_->anisotropy.a0 / 3.0 * direction_.dx * e : a2() * place_.P_ref;
    return place_;
  }

  const LawParameters<double>* p_;
  Rung rung_;
  Coupling coupling_;
  const StraightSegment* segment_;
  LawDirection direction_;
  double P_held_;
  Turning turning_ = Turning::rests;
  mutable double least_reversal_ = 0;
  mutable Place place_;
};

}  // namespace grainlaw::predict
