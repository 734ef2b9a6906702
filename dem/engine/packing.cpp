#include "dem/engine/packing.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "model/vocabulary/error.hpp"
#include "model/vocabulary/portable.hpp"

namespace grainlaw::dem {
namespace {

// Spheres far larger than the cell would touch an unbounded number of their own images.
constexpr double kMaxRadiusOverHeight = 2;
constexpr double kMaxFilling = 2;

}  // namespace

void resize(Packing& p, std::size_t n) {
  for (auto* a : {&p.radius, &p.mass, &p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz}) a->assign(n, 0.0);
  p.id.resize(n);
  std::iota(p.id.begin(), p.id.end(), std::int64_t{0});
}

void round_radii(Packing& packing) {
  if (packing.size() == 0) return;
  for (double before = 0;;) {
    const double r_max = *std::max_element(packing.radius.begin(), packing.radius.end());
    const double grid = std::ldexp(1.0, std::ilogb(r_max) + 2 - 24);
    if (grid == before || !(grid > 0)) return;  // once more when rounding has carried the largest over a power of two
    for (double& r : packing.radius) r = std::max(grid, grid * std::nearbyint(r / grid));
    before = grid;
  }
}

void set_masses(Packing& p, const Material& material) {
  std::transform(p.radius.begin(), p.radius.end(), p.mass.begin(), [&](double r) { return sphere_mass(material, r); });
}

double solid_volume(const Packing& p) {
  double cubes = 0;
  for (const double r : p.radius) cubes += r * r * r;
  return 4.0 / 3.0 * std::numbers::pi * cubes;
}

double volume_fraction(const Packing& p) { return solid_volume(p) / p.volume(); }

double mean_radius(const Packing& p) {
  if (p.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(p.radius.begin(), p.radius.end(), 0.0) / static_cast<double>(p.size());
}

void scale_to_volume_fraction(Packing& p, double nu, bool portable) {
  const double ratio = volume_fraction(p) / nu;
  p.H *= portable ? portable::cbrt(ratio) : std::cbrt(ratio);
}

void remove_drift(Packing& p) {
  const double total_mass = std::accumulate(p.mass.begin(), p.mass.end(), 0.0);
  for (auto* v : {&p.vx, &p.vy, &p.vz}) {
    double momentum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) momentum += p.mass[i] * (*v)[i];
    for (double& component : *v) component -= momentum / total_mass;
  }
}

void check(const Packing& p) {
  const std::size_t n = p.size();
  for (const auto* a : {&p.mass, &p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz}) {
    if (a->size() != n) throw InvalidInput("packing: its arrays differ in length");
  }
  if (p.id.size() != n) throw InvalidInput("packing: its arrays differ in length");
  const Eigen::Matrix3d& H = p.H;
  if (!H.allFinite() || H(1, 0) != 0 || H(2, 0) != 0 || H(2, 1) != 0 || !(H.diagonal().minCoeff() > 0)) {
    throw InvalidInput("cell: must be upper triangular with a positive, finite diagonal");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto refuse = [&](const char* what) { throw InvalidInput(fmt::format("sphere {}: {}", p.id[i], what)); };
    if (!(p.radius[i] > 0) || !std::isfinite(p.radius[i])) refuse("radius must be positive and finite");
    if (!(p.mass[i] > 0) || !std::isfinite(p.mass[i])) refuse("mass must be positive and finite");
    if (!std::isfinite(p.sx[i] + p.sy[i] + p.sz[i])) refuse("position must be finite");
    if (!std::isfinite(p.vx[i] + p.vy[i] + p.vz[i])) refuse("velocity must be finite");
  }
}

void check_sizes(const Packing& p) {
  if (p.size() == 0) return;
  const double height = p.H.inverse().rowwise().norm().cwiseInverse().minCoeff();
  const double largest = *std::max_element(p.radius.begin(), p.radius.end());
  if (!(largest <= kMaxRadiusOverHeight * height)) {
    throw InvalidInput(fmt::format("radius {} does not fit a cell of height {}; are both in metres?", largest, height));
  }
  if (!(volume_fraction(p) <= kMaxFilling)) {
    throw InvalidInput(fmt::format("the spheres fill {:.3g} times the cell; are both in metres?", volume_fraction(p)));
  }
}

void check(const Material& m) {
  for_each_field<Material>([&](const auto& field) {
    const double value = m.*field.access;
    const bool viscosity =
        field.access == &Material::contact_viscosity || field.access == &Material::background_viscosity;
    if (std::isfinite(value) && (viscosity ? value >= 0 : value > 0)) return;
    throw InvalidInput(fmt::format("{}: {} {} must be {} and finite", field.name, value, field.unit,
                                   viscosity ? "0 or more" : "positive"));
  });
}

double lightest_pair(const Packing& p) {
  if (p.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> lightest(std::min<std::size_t>(2, p.size()));
  std::partial_sort_copy(p.mass.begin(), p.mass.end(), lightest.begin(), lightest.end());
  return reduced_mass(lightest.front(), lightest.back());
}

double min_collision_time(const Packing& p, const Material& material) {
  return collision_time(material, lightest_pair(p));
}

}  // namespace grainlaw::dem
