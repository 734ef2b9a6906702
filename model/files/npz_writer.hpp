#pragma once
// Arrays as numpy's archive .npz, by libzip: a zip of .npy, version 1.0, little-endian, in C order.

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace grainlaw {

struct NamedArray {
  std::string name;                ///< key in numpy.load(FILE)
  std::vector<std::size_t> shape;  ///< its product is the number of values
  std::variant<std::vector<double>, std::vector<std::int64_t>> values;
};

/// Throws Error naming the file when it cannot be written whole; the earlier file stays then.
void write_npz(const std::filesystem::path& file, const std::vector<NamedArray>& arrays);

}  // namespace grainlaw
