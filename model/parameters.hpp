#pragma once
// The parameters of the law, declared once: the structs that the equations read and the table that files, bounds,
// help and the report derive from. Names of files and JSON are those of the table (docs/formats.md).

#include <array>
#include <limits>
#include <optional>
#include <string>

#include "model/density_laws.hpp"
#include "model/vocabulary/enum_names.hpp"

namespace grainlaw {

/// How the deviatoric and volumetric parts of Eq. (16) are coupled.
enum class Coupling {
  energy,  ///< A2 = a2 B F, and A1 = (2/3)(A2 - sigma_dev) by the energy identity
  single,  ///< Eq. (16) as printed: one A = a0 F in both rows, A1 = A, A2 = A/3
};
constexpr auto names_of(Coupling) { return std::array{"energy", "single"}; }

/// a0 of Eq. (19) and the pure numbers a1 = A1/(B F_dev), a2 = A2/(B F_dev).
template <class T>
struct Anisotropy {
  T a0{}, a1{}, a2{};
};

/// What the Lode angle of the shear changes of the limits of Eq. (20), which are those of D2; evolution.hpp.
template <class T>
struct LodeEffect {
  T stress_ratio{};  ///< psi_s: relative rise of s_max in D3 [-]
  T fabric{};        ///< psi_F: relative fall of F_max in D3, per nu/nu_c - 1 [-]
};

/// What the memory rung adds to Eq. (16), memory.hpp.
template <class T>
struct Memory {
  T G{}, alpha{};  ///< DG = G (nu_P/nu_c - 1)^alpha [-]
  T m{};           ///< exponent of first loading, S = 1 - xi^m; fixed [-]
  T k{};           ///< rate of P towards its sheared level [-]
  T lambda{};      ///< rate at which fabric follows stress [-]
  T c_F{};         ///< dilution of fabric by compression [-]
  T a2{};          ///< A2/(B F_dev), with fabric that is diluted [-]
  T chi{};         ///< rise of the limit of the stress ratio with dilatancy [-]
  T kappa{};       ///< share of the fabric that follows stress at once [-]
  T a_P{};         ///< A2/(B F_dev) of the elastic A1; fixed [-]
};

template <class T>
struct LawParameters {
  StateLaw<T> isotropic;               ///< ISO, unloading branch
  StateLaw<T> steady;                  ///< steady state of pure shear D2; not read by Eq. (16)
  T overlap_D{};                       ///< Eq. (13)
  T fabric_g3{};                       ///< F_v = g3 nu C
  T shear_nu_c{};                      ///< nu_c of Eq. (20), fixed: degenerate with Q_c and alpha
  ExponentialLaw<T> stress_ratio_max;  ///< s_max(nu)
  ExponentialLaw<T> stress_rate;       ///< beta_s(nu)
  ExponentialLaw<T> fabric_max;        ///< F_max(nu)
  ExponentialLaw<T> fabric_rate;       ///< beta_F(nu)
  LodeEffect<T> lode;
  Anisotropy<T> anisotropy;
  Memory<T> memory;
};

inline constexpr std::size_t kParameterCount = 46;

/// The fields in the order of parameter_table(). `Law` is LawParameters<T> or const LawParameters<T>.
template <class Law>
auto fields(Law& p) {
  auto& i = p.isotropic;
  auto& s = p.steady;
  // clang-format off
  return std::array{
      &i.coordination.C1, &i.coordination.alpha, &i.coordination.nu_c, &i.rattlers.phi_c, &i.rattlers.phi_v,
      &i.pressure.p0, &i.pressure.gamma_p, &i.pressure.nu_c,
      &s.coordination.C1, &s.coordination.alpha, &s.coordination.nu_c, &s.rattlers.phi_c, &s.rattlers.phi_v,
      &s.pressure.p0, &s.pressure.gamma_p, &s.pressure.nu_c,
      &p.overlap_D, &p.fabric_g3, &p.shear_nu_c,
      &p.stress_ratio_max.Q_limit, &p.stress_ratio_max.Q_c, &p.stress_ratio_max.alpha,
      &p.stress_rate.Q_limit, &p.stress_rate.Q_c, &p.stress_rate.alpha,
      &p.fabric_max.Q_limit, &p.fabric_max.Q_c, &p.fabric_max.alpha,
      &p.fabric_rate.Q_limit, &p.fabric_rate.Q_c, &p.fabric_rate.alpha,
      &p.lode.stress_ratio, &p.lode.fabric,
      &p.anisotropy.a0, &p.anisotropy.a1, &p.anisotropy.a2,
      &p.memory.G, &p.memory.alpha, &p.memory.m, &p.memory.k, &p.memory.lambda, &p.memory.c_F, &p.memory.a2,
      &p.memory.chi, &p.memory.kappa, &p.memory.a_P};
  // clang-format on
}

struct ParameterInfo {
  const char* name;                 ///< key in parameters.json
  const char* symbol;               ///< the paper's symbol
  const char* equation;             ///< number in the paper
  const char* meaning;              ///< one line for help and report; all parameters are dimensionless
  double lower, upper;              ///< physical bounds, kept by every fit
  double start;                     ///< where a fit without a better idea starts; not a published value
  std::optional<double> published;  ///< Imole et al. 2013, Tables 2 and 3, sections 5-7; empty where none
};

/// The one table of parameters.
const std::array<ParameterInfo, kParameterCount>& parameter_table();

/// Index in the table; throws InvalidInput naming an unknown `name`.
std::size_t parameter_index(const std::string& name);

/// All parameters at ParameterInfo::start.
LawParameters<double> start_parameters();

/// All parameters at the published values where there are any, else at `start`. For tests and studies only: no fit
/// may begin from it.
LawParameters<double> published_parameters();

/// Likewise with the rows of Table 2 for a mode that the calibrated law does not read: "UNI" in place of ISO, "D3" in
/// place of D2. As above for any other name.
LawParameters<double> published_parameters(const std::string& mode);

/// Scalar conversion, e.g. to a dual number with zero derivative.
template <class T>
LawParameters<T> cast(const LawParameters<double>& p) {
  LawParameters<T> q;
  const auto from = fields(p);
  const auto to = fields(q);
  for (std::size_t i = 0; i < kParameterCount; ++i) *to[i] = T(*from[i]);
  return q;
}

}  // namespace grainlaw
