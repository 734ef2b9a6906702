#pragma once
// numpy's .npy: "\x93NUMPY", version, length and text of a header {'descr', 'fortran_order', 'shape'}, then the numbers.
// Numbers of 4 or 8 bytes, floating or integer, of either byte order, alone or as fields of records; nothing pickled, nothing else.

#include <string>
#include <string_view>
#include <vector>

#include "model/files/foreign_table.hpp"

namespace grainlaw {

inline constexpr std::string_view kNpyMagic = "\x93NUMPY";

/// A number in each item of the array.
struct NpyField {
  std::string name;      ///< empty: the array has no fields
  char kind = 'f';       ///< 'f' floating, 'i' signed integer
  std::size_t size = 8;  ///< 4 or 8 [byte]
  bool big_endian = false;
  std::size_t offset = 0;  ///< within an item [byte]
};

struct NpyArray {
  std::vector<NpyField> fields;
  std::vector<std::size_t> shape;
  bool fortran_order = false;
  std::string_view data;  ///< items one after the other, into what was parsed

  std::size_t items() const;      ///< product of the shape
  std::size_t item_size() const;  ///< [byte]
  double number(std::size_t item, const NpyField& field) const;
};

/// `bytes` must outlive the result. Throws InvalidInput "NAME: ..." for what is not as above, or shorter or longer than it says.
NpyArray parse_npy(std::string_view bytes, const std::string& name);

/// Columns of a 1-D array of records or of numbers (one column), or of a 2-D array of numbers. Throws InvalidInput for others.
ForeignTable table_of_npy(const NpyArray& array, const std::string& name);

}  // namespace grainlaw
