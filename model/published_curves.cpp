#include "model/published_curves.hpp"

#include <functional>
#include <utility>

namespace grainlaw {
namespace {

using Law = LawParameters<double>;
using Curve = std::function<double(const Law&, double)>;

const std::vector<std::pair<const char*, Curve>>& curves() {
  static const std::vector<std::pair<const char*, Curve>> table{
      {"C_star", [](const Law& p, double nu) { return p.isotropic.coordination.C_star(nu); }},
      {"rattler_fraction",
       [](const Law& p, double nu) { return p.isotropic.rattlers.fraction(nu, p.isotropic.coordination.nu_c); }},
      {"P_star", [](const Law& p, double nu) { return p.isotropic.P_star(nu); }},
      {"steady_C_star", [](const Law& p, double nu) { return p.steady.coordination.C_star(nu); }},
      {"steady_rattler_fraction",
       [](const Law& p, double nu) { return p.steady.rattlers.fraction(nu, p.steady.coordination.nu_c); }},
      {"steady_P_star", [](const Law& p, double nu) { return p.steady.P_star(nu); }},
      {"stress_ratio_max", [](const Law& p, double nu) { return p.stress_ratio_max.value(nu, p.shear_nu_c); }},
      {"stress_rate", [](const Law& p, double nu) { return p.stress_rate.value(nu, p.shear_nu_c); }},
      {"fabric_max", [](const Law& p, double nu) { return p.fabric_max.value(nu, p.shear_nu_c); }},
      {"fabric_rate", [](const Law& p, double nu) { return p.fabric_rate.value(nu, p.shear_nu_c); }},
  };
  return table;
}

}  // namespace

std::vector<CurvePoint> published_curves(const Law& ours, const std::vector<double>& densities) {
  const Law published = published_parameters();
  std::vector<CurvePoint> points;
  for (const auto& [quantity, curve] : curves()) {
    for (const double nu : densities) {
      const CurvePoint point{quantity, nu, curve(ours, nu), curve(published, nu)};
      if (point.ours > 0 && point.published > 0) points.push_back(point);
    }
  }
  return points;
}

}  // namespace grainlaw
