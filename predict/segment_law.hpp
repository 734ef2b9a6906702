#pragma once
// Eq. (16), with or without memory, on a straight segment in the unknowns that are integrated. Its volumetric terms are
// total differentials, B dx = dP(nu) with P(nu) of Eq. (14), and need no integration where F' stays:
//   y = (Pi, tau (5), F' (5), s_r (5), E (5)),   P = P(nu) + Pi,   sigma' = tau + g F'
//   g = a2 P(nu) (Coupling::energy, memory) or (a0/3) ln(nu/nu_start) (Coupling::single), so that dg = (A2/F') dx
//   dPi = A1 S de,   dtau = DG (N - sigma'/(P s_max)) de - g dF',   dF', ds_r, dE as they are
// Memory's B is that at its own jamming density, and what it differs by from P(nu)'s stays in dPi and dtau.
// Without it an error made where P is large is carried down to where it is small: from nu = 0.82 to 0.67 it grows 54 times.

#include <algorithm>
#include <array>
#include <limits>

#include "model/law.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::predict {

inline constexpr std::size_t kUnknowns = 21;
using Unknowns = std::array<double, kUnknowns>;

/// The five numbers of a deviator among the unknowns.
inline Eigen::Map<Deviator<double>> deviator_at(double* y) { return Eigen::Map<Deviator<double>>(y); }
inline Eigen::Map<const Deviator<double>> deviator_at(const double* y) { return Eigen::Map<const Deviator<double>>(y); }

/// P, sigma', F', s_r, E in the order of the unknowns.
inline Unknowns packed(const LawState<double>& state) {
  Unknowns y;
  y[0] = state.P;
  deviator_at(y.data() + 1) = state.sigma;
  deviator_at(y.data() + 6) = state.F;
  deviator_at(y.data() + 11) = state.s_r;
  deviator_at(y.data() + 16) = state.E;
  return y;
}

inline LawState<double> unpacked(const double* y) {
  return {y[0], deviator_at(y + 1), deviator_at(y + 6), deviator_at(y + 11), deviator_at(y + 16)};
}

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
        direction_(law_direction(Eigen::Matrix3d(segment.direction.tensor + segment.spin))),
        P_held_(P_held) {}

  const StraightSegment& segment() const { return *segment_; }
  const LawDirection& direction() const { return direction_; }

  Unknowns unknowns_of(double e, const LawState<double>& state) const {
    const Place& here = at(e);
    Unknowns y = packed(state);
    y[0] -= here.P_ref;
    deviator_at(y.data() + 1) -= here.g * state.F;
    return y;
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
    LawState<double> held = state;
    held.P = std::max(state.P, P_held_);
    return law_rate(at(e).moduli, *p_, rung_, coupling_, held, direction_);
  }

  /// dy/de, into `rate`.
  void rate(double e, const double* y, double* rate) const {
    const LawState<double> state = state_of(e, y), of_state = state_rate(e, state);
    const Place& here = at(e);
    const LawModuli<double>& m = here.moduli;
    const double dg = single() ? p_->anisotropy.a0 / 3.0 : a2() * m.B;
    rate[0] = of_state.P - m.B * direction_.dx;
    deviator_at(rate + 1) = of_state.sigma - state.F * (dg * direction_.dx) - here.g * of_state.F;
    deviator_at(rate + 6) = of_state.F;
    deviator_at(rate + 11) = of_state.s_r;
    deviator_at(rate + 16) = of_state.E;
  }

  /// What a relative tolerance refers to: P, sigma', F', not the differences that stand for them.
  void scale(double e, const double* y, double* scale) const {
    const LawState<double> state = state_of(e, y);
    scale[0] = std::abs(state.P);
    deviator_at(scale + 1) = state.sigma.cwiseAbs();
    deviator_at(scale + 6) = state.F.cwiseAbs();
    deviator_at(scale + 11) = state.s_r.cwiseAbs();
    deviator_at(scale + 16) = state.E.cwiseAbs();
  }

 private:
  /// What depends on the path parameter alone: the expensive part of a rate, and the same for all that a solver asks
  /// at one place (rate, weights, events), hence kept. One object serves one thread.
  struct Place {
    double e = std::numeric_limits<double>::quiet_NaN();
    double P_ref = 0, g = 0;
    LawModuli<double> moduli{};
  };

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
  mutable Place place_;
};

}  // namespace grainlaw::predict
