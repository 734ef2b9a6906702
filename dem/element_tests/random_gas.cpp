#include "dem/element_tests/random_gas.hpp"

#include <Random123/philox.h>
#include <fmt/format.h>

#include <cmath>

#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr std::int64_t kMaxParticles = 100'000'000;
constexpr double kMaxSizeWidth = 1e3;
constexpr double kMaxGasDensity = 0.5;  // above it random positions jam on the way

// A collision at the thermal speed c <r> sqrt(k/<m>) overlaps by about c/sqrt(2) of the mean radius whatever k is: at
// c = 0.02 still a gas of hard spheres. With the paper's drag a sphere then runs c sqrt(k <m>)/gamma_b = 6 <r> before
// it stops, several times the mean free path at nu = 0.3: neighbours change, the lattice of chance is forgotten.
constexpr double kThermalSpeed = 0.02;

void require(bool ok, const char* key, double value, const char* rule) {
  if (!ok) throw InvalidInput(fmt::format("{}: {} {}", key, value, rule));
}

void check_options(const PackingOptions& o, double nu_gas) {
  require(o.particles >= 1 && o.particles <= kMaxParticles, "particles", static_cast<double>(o.particles),
          "is outside [1, 1e8]");
  require(o.size_width >= 1 && o.size_width <= kMaxSizeWidth, "size_width", o.size_width, "is outside [1, 1000]");
  require(o.mean_radius > 0 && std::isfinite(o.mean_radius), "mean_radius", o.mean_radius,
          "must be positive and finite");
  check(o.material);
  require(nu_gas > 0 && nu_gas <= kMaxGasDensity, "nu_gas", nu_gas, "is outside (0, 0.5]");
}

}  // namespace

std::array<std::uint64_t, 4> random_words(std::uint64_t seed, Stream stream, std::uint64_t block) {
  const r123::Philox4x64::ctr_type counter = {{block, 0, 0, 0}};
  const r123::Philox4x64::key_type key = {{seed, static_cast<std::uint64_t>(stream)}};
  const auto words = r123::Philox4x64()(counter, key);
  return {words[0], words[1], words[2], words[3]};
}

std::array<double, 4> uniform(std::uint64_t seed, Stream stream, std::uint64_t block) {
  std::array<double, 4> numbers{};
  const auto words = random_words(seed, stream, block);
  for (std::size_t i = 0; i < 4; ++i) numbers[i] = static_cast<double>(words[i] >> 11) * 0x1p-53;
  return numbers;
}

State random_gas(const PackingOptions& options, double nu_gas, const EngineOptions& engine, const RunControl& control) {
  check_options(options, nu_gas);
  State state;
  state.material = options.material;
  state.seed = options.seed;
  Packing& p = state.packing;
  resize(p, static_cast<std::size_t>(options.particles));
  const double w = options.size_width, r_min = 2 * options.mean_radius / (w + 1);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto position = uniform(options.seed, Stream::position, i);
    p.radius[i] = r_min * (1 + (w - 1) * uniform(options.seed, Stream::radius, i)[0]);
    p.sx[i] = position[0];
    p.sy[i] = position[1];
    p.sz[i] = position[2];
  }
  round_radii(p);  // the same packing in every precision
  set_masses(p, options.material);
  scale_to_volume_fraction(p, nu_gas, engine.portable_bits);

  // Random spheres overlap; they are pushed apart at fixed cell. What a hard case may leave stays repulsive.
  relax(state, engine, RelaxOptions{}, control);

  const double mean_mass = sphere_mass(options.material, options.mean_radius);
  // uniform on [-a, a] per component: the mean squared speed is a^2. Collisions make it Maxwell's.
  const double a = kThermalSpeed * options.mean_radius * std::sqrt(options.material.stiffness / mean_mass);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto u = uniform(options.seed, Stream::velocity, i);
    p.vx[i] = a * (2 * u[0] - 1);
    p.vy[i] = a * (2 * u[1] - 1);
    p.vz[i] = a * (2 * u[2] - 1);
  }
  remove_drift(p);
  return state;
}

}  // namespace grainlaw::dem
