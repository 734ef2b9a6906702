#pragma once
// Eq. (16) on a straight segment in the unknowns that are integrated. Its volumetric terms are total differentials,
// B dx = dP(nu) with P(nu) of Eq. (14), and need no integration where F' stays:
//   y = (Pi, tau (5), F' (5)),   P = P(nu) + Pi,   sigma' = tau + g F'
//   g = a2 P(nu) (Coupling::energy) or (a0/3) ln(nu/nu_start) (Coupling::single), so that dg = (A2/F') dx
//   dPi = A1 S de,   dtau = DG (N - sigma'/(P s_max)) de - g dF',   dF' as it is
// Without it an error made where P is large is carried down to where it is small: from nu = 0.82 to 0.67 it grows 54 times.

#include <algorithm>
#include <array>
#include <limits>

#include "model/evolution.hpp"
#include "model/path.hpp"

namespace grainlaw::predict {

inline constexpr std::size_t kUnknowns = 11;
using Unknowns = std::array<double, kUnknowns>;

/// The five numbers of a deviator among the unknowns.
inline Eigen::Map<Deviator<double>> deviator_at(double* y) { return Eigen::Map<Deviator<double>>(y); }
inline Eigen::Map<const Deviator<double>> deviator_at(const double* y) { return Eigen::Map<const Deviator<double>>(y); }

/// The law on one segment, continued harmlessly past the end of the jammed range, where trial steps of a solver look.
class SegmentLaw {
 public:
  /// Below `P_held` the rate is that at `P_held`. The arguments must outlive the object.
  SegmentLaw(const LawParameters<double>& parameters, Coupling coupling, const StraightSegment& segment, double P_held)
      : p_(&parameters),
        coupling_(coupling),
        segment_(&segment),
        direction_(law_direction(segment.direction)),
        P_held_(P_held) {}

  const StraightSegment& segment() const { return *segment_; }

  Unknowns unknowns_of(double e, const LawState<double>& state) const {
    Unknowns y;
    y[0] = state.P - p_->isotropic.P_star(segment_->nu(e));
    deviator_at(y.data() + 1) = state.sigma - g(e) * state.F;
    deviator_at(y.data() + 6) = state.F;
    return y;
  }

  LawState<double> state_of(double e, const double* y) const {
    const Deviator<double> tau = deviator_at(y + 1), F = deviator_at(y + 6);
    return {p_->isotropic.P_star(segment_->nu(e)) + y[0], tau + g(e) * F, F};
  }

  /// dy/de, into `rate`.
  void rate(double e, const double* y, double* rate) const {
    LawState<double> state = state_of(e, y);
    state.P = std::max(state.P, P_held_);
    // B jumps to zero at the jamming density; just above it is the limit that belongs to the jammed side.
    const double jammed = p_->isotropic.pressure.nu_c * (1 + 4 * std::numeric_limits<double>::epsilon());
    const LawModuli<double> m = moduli_at(*p_, std::max(segment_->nu(e), jammed));
    const LawState<double> of_state = evolution_rate(m, p_->anisotropy, coupling_, state, direction_);
    const double dg = coupling_ == Coupling::energy ? p_->anisotropy.a2 * m.B : p_->anisotropy.a0 / 3.0;
    rate[0] = of_state.P - m.B * direction_.dx;
    deviator_at(rate + 1) = of_state.sigma - state.F * (dg * direction_.dx) - g(e) * of_state.F;
    deviator_at(rate + 6) = of_state.F;
  }

  /// What a relative tolerance refers to: P, sigma', F', not the differences that stand for them.
  void scale(double e, const double* y, double* scale) const {
    const LawState<double> state = state_of(e, y);
    scale[0] = std::abs(state.P);
    deviator_at(scale + 1) = state.sigma.cwiseAbs();
    deviator_at(scale + 6) = state.F.cwiseAbs();
  }

 private:
  double g(double e) const {
    return coupling_ == Coupling::energy ? p_->anisotropy.a2 * p_->isotropic.P_star(segment_->nu(e))
                                         : p_->anisotropy.a0 / 3.0 * direction_.dx * e;
  }

  const LawParameters<double>* p_;
  Coupling coupling_;
  const StraightSegment* segment_;
  LawDirection direction_;
  double P_held_;
};

}  // namespace grainlaw::predict
