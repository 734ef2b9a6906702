#include "model/files/series_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/files/column.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/series_check.hpp"

namespace grainlaw {
namespace {

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
  }

  std::vector<Observation> read() {
    std::vector<double> values;
    while (reader_.next(values)) {
      Observation row;
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
    const auto derive = [&](const char* column, double& value, double computed) {
      if (!given_.contains(column)) value = computed;
    };
    Observation derived;  // what the given tensors say
    set_strain(derived, row.strain);
    derive("eps_vol", row.eps_vol, derived.eps_vol);
    derive("eps_dev", row.eps_dev, derived.eps_dev);
    const bool first = rows_.empty();
    derive("shear_path", row.shear_path,
           first ? 0
                 : rows_.back().shear_path +
                       (deviator<double>(row.strain.tensor) - deviator<double>(rows_.back().strain.tensor)).norm());
    // a corner of the path may be seen twice, at the end of one segment and the start of the next
    const bool corner = !first && row.segment > rows_.back().segment && row.time == rows_.back().time;
    if (!first && !corner && row.time <= rows_.back().time)
      reader_.refuse("time[s]", "does not grow from the row before");
    if (!first && row.segment < rows_.back().segment) reader_.refuse("segment", "falls behind that of the row before");

    const double P = row.stress.tensor.trace() / 3;
    set_ratios(derived, P, deviator<double>(row.stress.tensor), deviator<double>(row.fabric.tensor), N_);
    derive("P_star", row.P_star, P / packing_.stress_unit());
    derive("s_dev", row.s_dev, derived.s_dev);
    derive("s_par", row.s_par, derived.s_par);
    derive("F_v", row.F_v, row.fabric.tensor.trace());
    derive("F_dev", row.F_dev, derived.F_dev);
    derive("F_par", row.F_par, derived.F_par);
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

std::vector<Observation> read_series(const std::filesystem::path& file, const Path& path, const PackingInfo& packing) {
  return SeriesReader(file, path, packing).read();
}

}  // namespace grainlaw
