// fuzz_readers SCENE SECONDS [READER...]: every reader on its seeds and on changes of them for so long, in all; for machines
// without libFuzzer, and as a test. Exit code 1 at the first finding, whose bytes stay in finding-READER.

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>

#include "tests/fuzz/mutation.hpp"

namespace {

using namespace grainlaw::fuzz;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kLongestCall = 5;         // [s]
constexpr long kMostMemory = 1024 * 1024;  // [kB]
constexpr std::size_t kMostKept = 300, kMostBytes = 20000;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Calls made and accepted. What is accepted is changed further.
std::pair<long, long> run(const Reader& reader, std::vector<std::string> corpus, double seconds) {
  Chance chance(1);
  std::string bytes;
  const auto call = [&] {
    const Clock::time_point start = Clock::now();
    const bool accepted = accepts(reader, bytes);
    if (seconds_since(start) > kLongestCall) throw Finding(fmt::format("takes {:.1f} s", seconds_since(start)));
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    if (usage.ru_maxrss > kMostMemory) throw Finding(fmt::format("takes {} MB", usage.ru_maxrss / 1024));
    return accepted;
  };
  try {
    for (const std::string& seed : corpus) {
      bytes = seed;
      if (!call()) throw Finding("a seed is refused");
    }
    long calls = 0, accepted = 0;
    for (const Clock::time_point start = Clock::now(); seconds_since(start) < seconds; ++calls) {
      bytes = mutated(corpus[chance() % corpus.size()], reader.shape, chance,
                      [&](std::string& text) { mutate_bytes(text, chance); });
      if (!call()) continue;
      ++accepted;
      if (corpus.size() < kMostKept && bytes.size() < kMostBytes) corpus.push_back(bytes);
    }
    return {calls, accepted};
  } catch (const std::exception& error) {
    std::ofstream("finding-" + reader.name, std::ios::binary) << bytes;
    throw Finding(fmt::format("{}: {}; the bytes are in finding-{}", reader.name, error.what(), reader.name));
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) throw std::invalid_argument("usage: fuzz_readers SCENE SECONDS [READER...]");
  const fs::path scene = fs::absolute(argv[1]);
  const std::vector<std::string> wanted(argv + 3, argv + argc);
  std::vector<Reader> all = readers(scene);
  std::erase_if(all,
                [&](const Reader& reader) { return !wanted.empty() && std::ranges::count(wanted, reader.name) == 0; });
  for (const Reader& reader : all) {
    const auto [calls, accepted] =
        run(reader, seeds(reader, scene), std::atof(argv[2]) / static_cast<double>(all.size()));
    fmt::print("{:<14} {:>8} calls, {:>5.1f} % accepted\n", reader.name, calls,
               100.0 * static_cast<double>(accepted) / static_cast<double>(calls));
    std::fflush(stdout);
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "FINDING {}\n", error.what());
  return 1;
}
