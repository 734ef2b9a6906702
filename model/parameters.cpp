#include "model/parameters.hpp"

#include "model/vocabulary/error.hpp"

namespace grainlaw {

const std::array<ParameterInfo, kParameterCount>& parameter_table() {
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

std::size_t parameter_index(const std::string& name) {
  const auto& table = parameter_table();
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (name == table[i].name) return i;
  }
  throw InvalidInput("parameters: '" + name + "' is no parameter of the law; see docs/formats.md for the names");
}

LawParameters<double> start_parameters() {
  LawParameters<double> p;
  const auto to = fields(p);
  for (std::size_t i = 0; i < kParameterCount; ++i) *to[i] = parameter_table()[i].start;
  return p;
}

LawParameters<double> published_parameters() {
  LawParameters<double> p = start_parameters();
  const auto to = fields(p);
  for (std::size_t i = 0; i < kParameterCount; ++i) *to[i] = parameter_table()[i].published.value_or(*to[i]);
  return p;
}

LawParameters<double> published_parameters(const std::string& mode) {
  LawParameters<double> p = published_parameters();
  if (mode == "UNI") p.isotropic = {{8.3700, 0.5998, 0.6625}, {0.1507, 15.6835}, {0.04006, 0.03270, 0.6619}};
  if (mode == "D3") p.steady = {{7.9289, 0.5764, 0.6603}, {0.1327, 14.6813}, {0.03899, 0.02819, 0.6583}};
  return p;
}

}  // namespace grainlaw
