#include "model/files/series_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "model/files/column.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/series_check.hpp"

namespace grainlaw {
namespace {

/// `row` with all that follows from other columns.
Observation completed(Observation row, const Observation* before, double stress_unit, const Deviator<double>& N) {
  set_strain(row, row.strain);
  row.shear_path =
      before == nullptr
          ? 0
          : before->shear_path + (deviator<double>(row.strain.tensor) - deviator<double>(before->strain.tensor)).norm();
  row.P_star = set_following(row, N) / stress_unit;
  return row;
}

class SeriesReader {
 public:
  SeriesReader(const std::filesystem::path& file, const Path& path, const PackingInfo& packing)
      : reader_(file),
        columns_(matched<Observation>(reader_)),
        path_(path),
        packing_(packing),
        N_(shear_direction(resolve(path))) {
    for (const auto* column : columns_) given_.insert(column->name);
    if (path.segments.size() > 1 && !given_.contains("segment")) {
      reader_.refuse("", "misses the column 'segment': the path has several segments");
    }
    const auto fabrics =
        std::ranges::count_if(given_, [](const std::string& name) { return name.starts_with("fabric_"); });
    if (fabrics != 0 && fabrics != 6)
      reader_.refuse("", fmt::format("has {} of the six columns of fabric; give all or none", fabrics));
  }

  std::vector<Observation> read() {
    std::vector<double> values;
    while (reader_.next(values)) {
      Observation row;
      row.fabric.tensor.setConstant(Observation::undefined);
      for (std::size_t i = 0; i < values.size(); ++i) set(row, *columns_[i], values[i]);
      complete(row);
      rows_.push_back(row);
    }
    if (rows_.empty()) reader_.refuse("", "the series has no rows");
    check_contradictions(rows_, path_, packing_, reader_.name());
    return std::move(rows_);
  }

 private:
  void set(Observation& row, const Column<Observation>& column, double value) const {
    if (column.name == "segment" && !std::isnan(value) &&
        !(value >= 0 && value < static_cast<double>(std::max<std::size_t>(1, path_.segments.size())) &&
          value == std::trunc(value))) {
      reader_.refuse(column.title(),
                     fmt::format("{} is no segment of the path, which has {}", value, path_.segments.size()));
    }
    set_value(reader_, row, column, value);
  }

  /// What follows from other columns, where its own is absent.
  void complete(Observation& row) {
    const Observation* before = rows_.empty() ? nullptr : &rows_.back();
    // a corner of the path may be seen twice, at the end of one segment and the start of the next
    const bool corner = before != nullptr && row.segment > before->segment && row.time == before->time;
    if (before != nullptr && !corner && row.time <= before->time)
      reader_.refuse("time[s]", "does not grow from the row before");
    if (before != nullptr && row.segment < before->segment)
      reader_.refuse("segment", "falls behind that of the row before");
    const Observation read = std::exchange(row, completed(row, before, packing_.stress_unit(), N_));
    for (const auto* column : columns_) column->set(row, column->get(read));
    if (const auto* column = infinite_column(row))
      reader_.refuse("",
                     fmt::format("{} becomes infinite, so large are the numbers that it follows from", column->name));
  }

  CsvReader reader_;
  std::vector<const Column<Observation>*> columns_;
  const Path& path_;
  const PackingInfo& packing_;
  Deviator<double> N_;
  std::set<std::string> given_;
  std::vector<Observation> rows_;
};

}  // namespace

std::string series_text(const std::vector<Observation>& rows) { return table_text(rows); }

void write_series(const std::filesystem::path& file, const std::vector<Observation>& rows) {
  write_durably(file, series_text(rows));
}

void complete(std::vector<Observation>& rows, const Path& path, const PackingInfo& packing) {
  const Deviator<double> N = shear_direction(resolve(path));
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = completed(rows[i], i == 0 ? nullptr : &rows[i - 1], packing.stress_unit(), N);
}

std::vector<Observation> read_series(const std::filesystem::path& file, const Path& path, const PackingInfo& packing) {
  return SeriesReader(file, path, packing).read();
}

}  // namespace grainlaw
