#pragma once
// Spheres at one instant as somebody else's file has them, before its columns have a meaning: a table of numbers and, where
// the file has it, a cell. Every format of particles is read into this; dem/foreign/frame.hpp says what the columns are.

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dem/files/text_file.hpp"

namespace grainlaw::dem {

inline constexpr std::size_t kMaxForeignRows = 100'000'000;  ///< more are refused

/// Words that are no numbers are NaN.
struct NumberTable {
  std::vector<std::string> columns;  ///< titles
  std::vector<double> values;        ///< row by row
  std::size_t first_line = 0;        ///< of the file that row 0 is on; 0: the file has no lines

  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
};

struct ForeignFrame {
  std::filesystem::path file;
  std::string place;                                       ///< "step 1000"; empty: the file has one frame
  double step = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not told
  double time = std::numeric_limits<double>::quiet_NaN();  ///< as the file has it, NaN: not told
  std::optional<Eigen::Matrix3d> H;                        ///< columns are edge vectors
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();        ///< corner of the cell
  NumberTable table;

  /// "FILE: step 1000: line 17", for messages; row 0: none in particular.
  std::string where(std::size_t row = 0) const;

  /// What is wrong with it, or with a row (0: none in particular) and a column of it, as one line of text.
  InvalidInput refusal(const std::string& why, std::size_t row = 0, const std::string& column = "") const;
};

/// The frames of one file, one after the other.
class ForeignReader {
 public:
  virtual ~ForeignReader() = default;
  /// False behind the last frame. Throws InvalidInput naming file, line and remedy.
  virtual bool next(ForeignFrame& frame) = 0;
};

std::unique_ptr<ForeignReader> read_lammps_dump(const std::filesystem::path& file);   ///< dump custom and dump local
std::unique_ptr<ForeignReader> read_extended_xyz(const std::filesystem::path& file);  ///< as ASE and OVITO have it
std::unique_ptr<ForeignReader> read_vtk_xml(const std::filesystem::path& file);       ///< VTP, or points of a VTU
std::unique_ptr<ForeignReader> read_text_table(const std::filesystem::path& file);    ///< rows of numbers with titles

/// Titles of the first row: NAME_x, NAME_y, NAME_z for three components, NAME for one, else NAME_0, NAME_1, ...
std::vector<std::string> component_titles(const std::string& name, std::size_t components);

/// Appends `rows` lines of the file from the next one on to the table, each with as many words as there are columns. Throws
/// InvalidInput naming the line that is missing, or has another number of words.
void read_rows(TextFile& lines, std::size_t rows, NumberTable& table);

/// A number of rows as somebody's file claims it. Throws InvalidInput unless it is a whole number in [0, kMaxForeignRows].
std::size_t row_count(const TextFile& lines, std::string_view text);

}  // namespace grainlaw::dem
