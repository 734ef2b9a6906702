#include "model/files/series_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/files/column.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

constexpr double kConsistency =
    1e-3;  // relative; files of others may carry few digits, and a wrong unit or column is far off

class SeriesReader {
 public:
  SeriesReader(const std::filesystem::path& file, const Path& path, const PackingInfo& packing)
      : reader_(file),
        columns_(matched<Observation>(reader_)),
        path_(path),
        stress_unit_(packing.stress_unit()),
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

  /// Fills `value` when its column is absent; otherwise it must agree with `computed`.
  void derive(const char* column, double& value, double computed, double scale) const {
    if (!given_.contains(column)) {
      value = computed;
    } else if (!std::isnan(value) && std::abs(value - computed) > kConsistency * std::max(scale, std::abs(computed))) {
      reader_.refuse(
          column, fmt::format("{} contradicts the other columns, which give {:.8g}; check units and order of columns",
                              value, computed));
    }
  }

  void complete(Observation& row) {
    if (!(row.nu > 0 && row.nu <= 0.9))
      reader_.refuse("nu", fmt::format("{} is no volume fraction in (0, 0.9]", row.nu));
    const bool first = rows_.empty();
    Observation derived;  // what the given tensors say
    set_strain(derived, row.strain);
    derive("eps_vol", row.eps_vol, derived.eps_vol, 1e-3);
    derive("eps_dev", row.eps_dev, derived.eps_dev, 1e-3);
    const double nu_0 = first ? row.nu * std::exp(row.eps_vol) : nu_0_;
    if (first) nu_0_ = nu_0;
    double nu = row.nu;
    derive("nu", nu, nu_0 * std::exp(-row.eps_vol), 1e-3);
    if (!given_.contains("shear_path")) {
      row.shear_path =
          first ? 0
                : rows_.back().shear_path +
                      (deviator<double>(row.strain.tensor) - deviator<double>(rows_.back().strain.tensor)).norm();
    }
    // a corner of the path may be seen twice, at the end of one segment and the start of the next
    const bool corner = !first && row.segment > rows_.back().segment && row.time == rows_.back().time;
    if (!first && !corner && row.time <= rows_.back().time)
      reader_.refuse("time[s]", "does not grow from the row before");
    if (!first && row.segment < rows_.back().segment) reader_.refuse("segment", "falls behind that of the row before");

    const double P = row.stress.tensor.trace() / 3;
    set_ratios(derived, P, deviator<double>(row.stress.tensor), deviator<double>(row.fabric.tensor), N_);
    derive("P_star", row.P_star, P / stress_unit_, 1e-9);
    derive("s_dev", row.s_dev, derived.s_dev, 1e-3);
    derive("s_par", row.s_par, derived.s_par, 1e-3);
    derive("F_v", row.F_v, row.fabric.tensor.trace(), 1e-3);
    derive("F_dev", row.F_dev, derived.F_dev, 1e-3);
    derive("F_par", row.F_par, derived.F_par, 1e-3);
  }

  CsvReader reader_;
  std::vector<const Column<Observation>*> columns_;
  const Path& path_;
  double stress_unit_;  // [Pa]
  Deviator<double> N_;
  std::set<std::string> given_;
  double nu_0_ = 0;  // volume fraction at zero strain
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
