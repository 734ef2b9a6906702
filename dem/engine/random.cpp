#include "dem/engine/random.hpp"

#include <Random123/philox.h>

namespace grainlaw::dem {

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

}  // namespace grainlaw::dem
