#pragma once
// The parameters of the law, declared once: the structs that the equations read and the table that files, bounds,
// help and the report derive from. Names of files and JSON are those of the table (docs/formats.md).

#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

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

inline constexpr std::size_t kParameterCount =
    std::tuple_size_v<decltype(fields(std::declval<LawParameters<double>&>()))>;

struct ParameterInfo {
  const char* name;                 ///< key in parameters.json
  const char* symbol;               ///< the paper's symbol
  const char* equation;             ///< number in the paper
  const char* meaning;              ///< one line for help and report; all parameters are dimensionless
  double lower, upper;              ///< physical bounds, kept by every fit
  double start;                     ///< where a fit without a better idea starts; not a published value
  std::optional<double> published;  ///< Imole et al. 2013, Tables 2 and 3, sections 5-7; empty where none
};

/// The one table of parameters, in the order of fields().
inline const std::array<ParameterInfo, kParameterCount>& parameter_table() {
  constexpr auto none = std::nullopt;
  // Starting values are round numbers of the right order, deliberately off the published ones. alpha of Eq. (20) stays
  // above zero, where Q_limit and Q_c would be one number.
  // clang-format off
  static const std::array<ParameterInfo, kParameterCount> table{{
      {"coordination.C1", "C_1", "11", "corrected coordination number, ISO unloading: prefactor", 0.1, 50, 7, 8.2720},
      {"coordination.alpha", "alpha", "11", "corrected coordination number, ISO unloading: exponent", 0.05, 2, 0.5, 0.5814},
      {"coordination.nu_c", "nu_c", "11", "corrected coordination number, ISO unloading: jamming volume fraction", 0.5, 0.74, 0.65, 0.6646},
      {"rattlers.phi_c", "phi_c", "12", "rattler fraction at jamming, ISO unloading", 0, 0.9, 0.1, 0.1216},
      {"rattlers.phi_v", "phi_v", "12", "decay of the rattler fraction with density, ISO unloading", 0, 200, 10, 15.8950},
      {"pressure.p0", "p_0", "14", "pressure prefactor, ISO unloading", 1e-4, 1, 0.05, 0.04172},
      {"pressure.gamma_p", "gamma_p", "14", "pressure nonlinearity, ISO unloading", -3, 3, 0, 0.06228},
      {"pressure.nu_c", "nu_c", "14", "pressure, ISO unloading: jamming volume fraction", 0.5, 0.74, 0.65, 0.6649},
      {"steady_coordination.C1", "C_1", "11", "corrected coordination number, steady D2: prefactor", 0.1, 50, 7, 7.9219},
      {"steady_coordination.alpha", "alpha", "11", "corrected coordination number, steady D2: exponent", 0.05, 2, 0.5, 0.5769},
      {"steady_coordination.nu_c", "nu_c", "11", "corrected coordination number, steady D2: jamming volume fraction", 0.5, 0.74, 0.65, 0.6601},
      {"steady_rattlers.phi_c", "phi_c", "12", "rattler fraction at jamming, steady D2", 0, 0.9, 0.1, 0.1363},
      {"steady_rattlers.phi_v", "phi_v", "12", "decay of the rattler fraction with density, steady D2", 0, 200, 10, 15.0010},
      {"steady_pressure.p0", "p_0", "14", "pressure prefactor, steady D2", 1e-4, 1, 0.05, 0.03886},
      {"steady_pressure.gamma_p", "gamma_p", "14", "pressure nonlinearity, steady D2", -3, 3, 0, 0.03219},
      {"steady_pressure.nu_c", "nu_c", "14", "pressure, steady D2: jamming volume fraction", 0.5, 0.74, 0.65, 0.6581},
      {"overlap.D", "D", "13", "mean overlap over volumetric strain since jamming", 0, 10, 0.5, 0.425},
      {"fabric.g3", "g_3", "F_v = g3 nu C", "polydispersity correction of the isotropic fabric", 0.5, 5, 1, 1.22},
      {"shear.nu_c", "nu_c", "20", "jamming volume fraction of Eq. (20), fixed", 0.5, 0.74, 0.6653, 0.6653},
      {"stress_ratio_max.Q_limit", "s_max: Q_max", "20", "steady stress ratio at large density", 0, 1, 0.1, 0.1137},
      {"stress_ratio_max.Q_c", "s_max: Q_c", "20", "steady stress ratio: excess at jamming", 0, 2, 0.1, 0.09166},
      {"stress_ratio_max.alpha", "s_max: alpha", "20", "steady stress ratio: decay with density", 0.1, 100, 10, 7.916},
      {"stress_rate.Q_limit", "beta_s: Q_max", "20", "growth rate of the stress ratio at large density", 0, 500, 30, 30.76},
      {"stress_rate.Q_c", "beta_s: Q_c", "20", "growth rate of the stress ratio: excess at jamming", 0, 1000, 50, 57.0},
      {"stress_rate.alpha", "beta_s: alpha", "20", "growth rate of the stress ratio: decay with density", 0.1, 200, 10, 16.86},
      {"fabric_max.Q_limit", "F_max: Q_max", "20", "steady deviatoric fabric at large density", 0, 1, 0, 0.0},
      {"fabric_max.Q_c", "F_max: Q_c", "20", "steady deviatoric fabric: excess at jamming", 0, 2, 0.1, 0.1694},
      {"fabric_max.alpha", "F_max: alpha", "20", "steady deviatoric fabric: decay with density", 0.1, 100, 5, 4.562},
      {"fabric_rate.Q_limit", "beta_F: Q_max", "20", "growth rate of the fabric at large density", 0, 500, 0, 0.0},
      {"fabric_rate.Q_c", "beta_F: Q_c", "20", "growth rate of the fabric: excess at jamming", 0, 1000, 50, 57.89},
      {"fabric_rate.alpha", "beta_F: alpha", "20", "growth rate of the fabric: decay with density", 0.1, 100, 5, 5.366},
      {"lode.stress_ratio", "psi_s", "Lode angle", "rise of the steady stress ratio from D2 to D3, relative", -0.5, 0.5, 0, none},
      {"lode.fabric", "psi_F", "Lode angle", "fall of the steady deviatoric fabric from D2 to D3, relative, per nu/nu_c - 1", -1.5, 1.5, 0, none},
      {"anisotropy.a0", "a_0", "19", "A* = a0 F_dev of the printed single coupling", 0, 10, 0.3, 0.137},
      {"anisotropy.a1", "a_1", "16", "A1/(B F_dev), pressure row", -10, 10, 0.7, none},
      {"anisotropy.a2", "a_2", "16", "A2/(B F_dev), deviatoric stress row", -10, 10, 1, none},
      {"memory.G", "G", "memory", "elastic shear modulus 2G* = G (nu_P/nu_c - 1)^alpha: prefactor", 0.01, 10, 0.5, none},
      {"memory.alpha", "alpha", "memory", "elastic shear modulus: exponent", 0.05, 2, 0.5, none},
      {"memory.m", "m", "memory", "exponent of first loading, S = 1 - xi^m, fixed", 1, 20, 2.5, none},
      {"memory.k", "k", "memory", "rate in shear at which P* goes to its sheared level", 0, 500, 20, none},
      {"memory.lambda", "lambda", "memory", "rate in shear at which fabric follows stress", 1, 2000, 50, none},
      {"memory.c_F", "c_F", "memory", "dilution by compression, of fabric in proportion to stress", -100, 100, 5, none},
      {"memory.a2", "a_2", "memory", "A2/(B F_dev) with fabric that compression dilutes", -10, 10, 1, none},
      {"memory.chi", "chi", "memory", "rise of the limit of the stress ratio with dilatancy", 0, 3, 0.5, none},
      {"memory.kappa", "kappa", "memory", "share of the fabric that follows stress at once", 0, 0.95, 0.5, none},
      {"memory.a_P", "a_P", "memory", "A2/(B F_dev) of the elastic A1, fixed", 0, 10, 1.18, none},
  }};
  // clang-format on
  return table;
}

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
