#pragma once
// Counter-based random numbers: Philox4x64-10 (Salmon et al., SC'11), keyed by (seed, stream) and addressed by index.
// A number is a function of these three alone, so what is drawn does not depend on order, threads or platform; no
// function of libm is involved.

#include <array>
#include <cstdint>

namespace grainlaw::dem {

/// What a number is drawn for: draws of different streams are independent.
enum class Stream : std::uint64_t { radius = 1, position = 2, velocity = 3 };

/// Four independent 64-bit words number 4*block .. 4*block+3 of the sequence (seed, stream).
std::array<std::uint64_t, 4> random_words(std::uint64_t seed, Stream stream, std::uint64_t block);

/// Four independent numbers, uniform in [0, 1) with 53 bits, from random_words().
std::array<double, 4> uniform(std::uint64_t seed, Stream stream, std::uint64_t block);

}  // namespace grainlaw::dem
