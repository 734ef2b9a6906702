#pragma once
// numpy's .npz: a zip archive of .npy files, NAME.npy for the array NAME.

#include <string>
#include <string_view>

#include "model/files/foreign_table.hpp"

namespace grainlaw {

/// The table in an archive: the array called `array`; or, where that is empty, the only 2-D array or array of records, or else
/// all 1-D arrays of the most frequent length as columns; the others are named in left_out. Throws InvalidInput "NAME: ..." for what
/// is no such archive, is damaged, encrypted or too large, or leaves the choice open.
ForeignTable table_of_npz(std::string_view bytes, const std::string& name, const std::string& array);

}  // namespace grainlaw
