#include "dem/element_tests/random_gas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace grainlaw::dem {
namespace {

constexpr std::uint64_t kSeed = 20130701;

/// Philox4x64-10 written from the paper (SC'11, section 3.3), independent of the library in use.
std::array<std::uint64_t, 4> philox(std::array<std::uint64_t, 4> c, std::uint64_t k0, std::uint64_t k1) {
  const auto high = [](std::uint64_t a, std::uint64_t b) {  // upper word of the product, by 32-bit halves
    const std::uint64_t mask = 0xffffffff, a0 = a & mask, a1 = a >> 32, b0 = b & mask, b1 = b >> 32;
    const std::uint64_t middle = a1 * b0 + ((a0 * b0) >> 32), low = a0 * b1 + (middle & mask);
    return a1 * b1 + (middle >> 32) + (low >> 32);
  };
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t m0 = 0xD2E7470EE14C6C93, m1 = 0xCA5A826395121157;
    c = {high(m1, c[2]) ^ c[1] ^ k0, m1 * c[2], high(m0, c[0]) ^ c[3] ^ k1, m0 * c[0]};
    k0 += 0x9E3779B97F4A7C15;
    k1 += 0xBB67AE8584CAA73B;
  }
  return c;
}

TEST(Random, WordsArePhilox) {
  for (std::uint64_t block : {std::uint64_t{0}, std::uint64_t{1}, ~std::uint64_t{0}}) {
    EXPECT_EQ(random_words(kSeed, Stream::position, block),
              philox({block, 0, 0, 0}, kSeed, static_cast<std::uint64_t>(Stream::position)));
  }
}

TEST(Random, UniformIsAFunctionOfSeedStreamAndBlock) {
  EXPECT_EQ(uniform(kSeed, Stream::radius, 7), uniform(kSeed, Stream::radius, 7));
  std::set<double> seen;
  for (std::uint64_t seed : {kSeed, kSeed + 1}) {
    for (Stream stream : {Stream::radius, Stream::position, Stream::velocity}) {
      for (std::uint64_t block = 0; block < 100; ++block) {
        for (const double u : uniform(seed, stream, block)) seen.insert(u);
      }
    }
  }
  EXPECT_EQ(seen.size(), 2u * 3u * 100u * 4u) << "two different addresses gave one number";
}

// Mean 1/2 and variance 1/12 of n numbers lie within five standard errors; so does the correlation of neighbours.
TEST(Random, UniformHasTheMomentsOfTheUniformDistribution) {
  const std::uint64_t blocks = 25000;
  const double n = 4.0 * blocks;
  double sum = 0, squares = 0, products = 0, previous = 0.5;
  for (std::uint64_t block = 0; block < blocks; ++block) {
    for (const double u : uniform(kSeed, Stream::velocity, block)) {
      ASSERT_GE(u, 0.0);
      ASSERT_LT(u, 1.0);
      sum += u;
      squares += (u - 0.5) * (u - 0.5);
      products += (u - 0.5) * (previous - 0.5);
      previous = u;
    }
  }
  EXPECT_NEAR(sum / n, 0.5, 5 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(squares / n, 1.0 / 12, 5 * std::sqrt(1.0 / 180 / n));
  EXPECT_NEAR(products / n, 0.0, 5 * std::sqrt(1.0 / 144 / n));
}

TEST(Random, UniformKeepsTheUpper53Bits) {
  const auto words = random_words(kSeed, Stream::radius, 3);
  const auto numbers = uniform(kSeed, Stream::radius, 3);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(std::ldexp(numbers[i], 53), static_cast<double>(words[i] >> 11));
}

}  // namespace
}  // namespace grainlaw::dem
