#pragma once
// Where every packing begins: a gas of spheres whose radii, places and velocities are drawn by counter-based random
// numbers, Philox4x64-10 (Salmon et al., SC'11), keyed by (seed, stream) and addressed by index. A number is a function
// of these three alone, so what is drawn does not depend on order, threads or platform; no function of libm is
// involved.

#include <array>
#include <cstdint>

#include "dem/statics/relax.hpp"

namespace grainlaw::dem {

/// What a number is drawn for: draws of different streams are independent.
enum class Stream : std::uint64_t { radius = 1, position = 2, velocity = 3 };

/// Four independent 64-bit words number 4*block .. 4*block+3 of the sequence (seed, stream).
std::array<std::uint64_t, 4> random_words(std::uint64_t seed, Stream stream, std::uint64_t block);

/// Four independent numbers, uniform in [0, 1) with 53 bits, from random_words().
std::array<double, 4> uniform(std::uint64_t seed, Stream stream, std::uint64_t block);

struct PackingOptions {
  std::int64_t particles = 2000;  ///< N
  double size_width = 3;          ///< w = r_max/r_min of the uniform distribution, >= 1 [-]
  double mean_radius = 1e-3;      ///< mean of the distribution [m]
  std::uint64_t seed = 1;         ///< key of the generator
  Material material;
};
constexpr auto fields_of(std::type_identity<PackingOptions>) {
  using P = PackingOptions;
  return std::tuple{
      Field{&P::particles, "particles", "", "N", "number of spheres of a packing"},
      Field{&P::size_width, "size_width", "", "w", "w = r_max/r_min of the uniform size distribution"},
      Field{&P::mean_radius, "mean_radius", "m", "<r>", "mean of the size distribution"},
      Field{&P::seed, "seed", "", "", "seed of the packing", Rule::fixed},  // a key of TEST, a list in SPEC
      Field{&P::material, ""}};
}
static_assert(tells_every_member<PackingOptions>());

/// The random gas: radii uniform on 2<r>/(w+1) [1, w], random positions without overlap beyond what the relaxation
/// removes, random velocities, zero momentum, volume fraction nu_gas, cubic cell. Throws InvalidInput naming the key.
State random_gas(const PackingOptions& options, double nu_gas, const EngineOptions& engine, const RunControl& control);

}  // namespace grainlaw::dem
