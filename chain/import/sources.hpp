#pragma once
// A foreign table with what its columns are taken for: named by a mapping or guessed, with units.

#include <map>
#include <memory>
#include <string>

#include "chain/import/foreign_rows.hpp"
#include "chain/import/mapping.hpp"
#include "model/files/foreign_table.hpp"

namespace grainlaw::chain {

class Sources {
 public:
  /// Reads the table of `test`. Throws InvalidInput naming file and column for what is missing, ambiguous or in no known unit.
  Sources(const Mapping& mapping, const TestMapping& test);

  std::size_t rows() const { return table_->rows(); }
  const std::string& table() const { return table_->name; }
  const std::string& mapping() const { return mapping_; }
  bool has(const std::string& quantity) const { return sources_.contains(quantity); }
  bool has_tensor(const std::string& name) const;  ///< any of its normal components
  bool has_edges() const;                          ///< of the cell
  bool tells_volume() const;                       ///< volume fraction, void ratio or porosity

  /// In our unit, NaN where the table has no such column. Throws InvalidInput for what is no finite number, unless it is undefined
  /// and may be.
  double value(std::size_t row, const std::string& quantity, bool may_be_undefined = false) const;
  /// Components that are not given are zero.
  Eigen::Matrix3d tensor(std::size_t row, const std::string& name) const;
  double volume_fraction(std::size_t row) const;  ///< NaN where no column tells it [-]

  /// The quantity whose column stands for all of stress, or strain, in messages.
  std::string stress_column() const;
  std::string strain_column() const;
  /// "FILE: line 17, column 'sxx'"; the line alone for what is no quantity of the table.
  std::string place(std::size_t row, const std::string& quantity) const;
  /// Likewise of one of the columns of our series, which may follow from others.
  std::string place_of_ours(std::size_t row, const std::string& column) const;

  /// Columns, extra columns and provenance of `foreign`, with the signs that were settled.
  void describe(Positive stress, Positive strain, ForeignRows& foreign) const;

 private:
  struct Source {
    const ForeignColumn* column;
    double factor;     // to our unit
    std::string unit;  // as it is read
    bool declared;     // by the mapping
  };

  [[noreturn]] void refuse(const std::string& why) const;
  const ForeignColumn* find_column(const ColumnChoice& choice) const;
  void take(const std::map<std::string, ColumnChoice>& columns, const std::string& where);
  void guess();
  void drop_what_follows();
  void require_tensor(const std::string& name, std::size_t components) const;
  void require_all(const SeriesMapping& how) const;
  void set_units(const std::map<std::string, std::string>& units, double stress_unit);

  std::string mapping_;  // name of its file
  std::shared_ptr<const ForeignTable> table_;
  std::string sha256_;                     // of its file
  std::map<std::string, Source> sources_;  // by quantity
};

}  // namespace grainlaw::chain
