#pragma once
// MAPPING.json: what the columns of foreign tables mean (docs/schemas/import.schema.json, docs/formats.md). Nothing is read but
// this file; series (import/series.hpp) and particles are read by what it says.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/files/json_document.hpp"
#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::chain {

/// What is positive in a table.
enum class Positive { compression, tension };
constexpr auto names_of(Positive) { return std::array{"compression", "tension"}; }

enum class Delimiter { comma, semicolon, tab, blank };
constexpr auto names_of(Delimiter) { return std::array{"comma", "semicolon", "tab", "blank"}; }

/// Where a quantity stands.
struct ColumnChoice {
  std::string name;                 ///< of the column; empty: by number
  std::size_t number = 0;           ///< from 1; 0: by name
  std::optional<std::string> unit;  ///< none: that of the title, or of the kind of quantity
};

/// How a table of rows is to be read.
struct SeriesMapping {
  std::filesystem::path file;                   ///< as it is opened; empty: not given
  std::optional<Delimiter> delimiter;           ///< none: seen from the first line
  char decimal = '.';                           ///< sign before the decimals of a text's numbers, . or ,
  std::size_t skip = 0;                         ///< lines of a text above its header
  std::string array;                            ///< of an .npz; empty: its 1-D arrays are the columns
  std::vector<std::string> names;               ///< of the columns of a table without a header; empty: it has one
  std::map<std::string, ColumnChoice> columns;  ///< by quantity; empty: guessed
  std::map<std::string, std::string> units;     ///< by kind, "stress" or "strain", of columns that do not say theirs
  std::optional<Positive> stress_sign, strain_sign;  ///< none: must be evident
  bool nominal = false;                              ///< strains are changes of length over the first length
  bool engineering_shear = false;                    ///< shear strains are twice the tensor's components
  bool isotropic = false;                            ///< strain follows from the volume alone, stress from p alone
  int axis = 2;                                      ///< of a triaxial test
  std::optional<double> nu_start;                    ///< volume fraction of the first row [-]
};

struct TestMapping {
  std::string name;
  Role role = Role::calibration;
  std::optional<PackingInfo> packing;  ///< as far as it is given, the rest zero; none: there are no packings
  std::vector<PathSegment> segments;   ///< of the given path; empty: to be found from the strains
  std::optional<double> nu;            ///< where the given path starts; none: where the rows do
  Branch branch = Branch::unloading;   ///< likewise
  double path_tolerance = 1e-4;        ///< strain by which rows may miss the path that they are moved to [-]
  std::optional<SeriesMapping> series;
  Json particles;  ///< what stands under "particles", with what holds for all tests; null: none
};

struct Mapping {
  std::string name;              ///< of the file, for messages
  std::filesystem::path folder;  ///< that other files are relative to
  std::string sha256;            ///< of the file
  std::string source;            ///< whose data it is
  std::vector<TestMapping> tests;
};

/// Throws InvalidInput naming file and key.
Mapping read_mapping(const std::filesystem::path& file);

/// Throws InvalidInput naming the key of the test's packing that an import of rows needs and that is missing.
void require_packing(const Mapping& mapping, const TestMapping& test);

}  // namespace grainlaw::chain
