#include "predict/prediction_series.hpp"

#include "model/files/column.hpp"
#include "model/files/output.hpp"

namespace grainlaw::predict {

void write_prediction_series(const std::filesystem::path& file, const std::vector<PredictedRow>& rows) {
  write_durably(file, table_text(rows));
}

std::vector<PredictedRow> read_prediction_series(const std::filesystem::path& file) {
  CsvReader reader(file);
  const auto columns = matched<PredictedRow>(reader);
  std::vector<PredictedRow> rows;
  std::vector<double> values;
  while (reader.next(values)) {
    PredictedRow row;
    row.state.sigma.setZero();
    row.state.F.setZero();
    for (std::size_t i = 0; i < values.size(); ++i) set_value(reader, row, *columns[i], values[i]);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace grainlaw::predict
