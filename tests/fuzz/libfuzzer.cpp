// One reader under libFuzzer: the environment names it (GRAINLAW_READER), its scene (GRAINLAW_SCENE) and the folder that its
// seeds are put into (GRAINLAW_SEEDS).

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tests/fuzz/mutation.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using namespace grainlaw::fuzz;

const Reader& chosen() {
  static const Reader reader = [] {
    const char *name = std::getenv("GRAINLAW_READER"), *scene = std::getenv("GRAINLAW_SCENE");
    if (name == nullptr || scene == nullptr)
      throw std::invalid_argument("GRAINLAW_READER and GRAINLAW_SCENE are not set");
    for (const Reader& each : readers(scene)) {
      if (each.name == name) return each;
    }
    throw std::invalid_argument(std::string(name) + " is no reader");
  }();
  return reader;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* folder = std::getenv("GRAINLAW_SEEDS");
  if (folder == nullptr) return 0;
  int count = 0;
  for (const std::string& seed : seeds(chosen(), std::getenv("GRAINLAW_SCENE")))
    std::ofstream(std::filesystem::path(folder) / std::to_string(count++), std::ios::binary) << seed;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    accepts(chosen(), {reinterpret_cast<const char*>(data), size});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "FINDING: %s\n", error.what());
    std::abort();
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  Chance chance(seed + 1);
  const ByteMutation bytes = [&](std::string& text) {
    std::string room = text.substr(0, max_size);
    const std::size_t used = room.size();
    room.resize(max_size);
    room.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(room.data()), used, max_size));
    text = room;
  };
  const std::string text = mutated({reinterpret_cast<const char*>(data), size}, chosen().shape, chance, bytes);
  if (text.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::copy(text.begin(), text.end(), data);
  return text.size();
}
