#include "predict/prediction_series.hpp"

#include <cmath>

#include "model/files/column_csv.hpp"
#include "model/files/durable_file.hpp"

namespace grainlaw::predict {
namespace {

/// Components of a deviator of the predicted state; writing keeps the tensor, reading goes back to coordinates.
template <Deviator<double> LawState<double>::*member, std::size_t k>
double get_deviator(const PredictedRow& row) {
  return tensor_of<double>(row.state.*member)(kComponentIndex[k][0], kComponentIndex[k][1]);
}
template <Deviator<double> LawState<double>::*member, std::size_t k>
void set_deviator(PredictedRow& row, double value) {
  Matrix3<double> tensor = tensor_of<double>(row.state.*member);
  // the diagonal arrives as xx, yy, zz: the last one follows from the trace, so set it only through xx and yy
  if (k == 2) return;
  tensor(kComponentIndex[k][0], kComponentIndex[k][1]) = value;
  tensor(kComponentIndex[k][1], kComponentIndex[k][0]) = value;
  tensor(2, 2) = -tensor(0, 0) - tensor(1, 1);
  row.state.*member = deviator<double>(tensor);
}
template <Deviator<double> LawState<double>::*member, std::size_t k = 0>
void add_deviator(Columns<PredictedRow>& columns, const std::string& name, const std::string& symbol,
                  const std::string& meaning) {
  const std::string suffix = kComponentName[k];
  columns.push_back({name + "_" + suffix, "", symbol + "_" + suffix, meaning + ", component " + suffix,
                     &get_deviator<member, k>, &set_deviator<member, k>, true});
  if constexpr (k + 1 < kComponentName.size()) add_deviator<member, k + 1>(columns, name, symbol, meaning);
}

/// Half widths of the two bands about one quantity.
template <double RowBand::*member>
void add_bands(Columns<PredictedRow>& columns, const std::string& name, const std::string& symbol) {
  using R = PredictedRow;
  columns.push_back({name + "_mean95", "", "", "half width of the 95 % band of the mean curve about " + symbol,
                     [](const R& r) { return r.mean.*member; }, [](R& r, double v) { r.mean.*member = v; }});
  columns.push_back({name + "_single95", "", "", "half width of the 95 % band of a single run about " + symbol,
                     [](const R& r) { return r.single.*member; }, [](R& r, double v) { r.single.*member = v; }});
}

Columns<PredictedRow> make_prediction_columns() {
  using R = PredictedRow;
  Columns<R> c;
  add<&R::segment>(c, "segment", "", "", "index of the path's segment, from 0", true);
  add_tensor<&R::strain>(c, "strain", "", "eps", "logarithmic strain since the start of the path, tension positive",
                         true);
  add<&R::eps_vol>(c, "eps_vol", "", "eps_vol", "volumetric strain ln(V/V0), negative in compression", true);
  add<&R::eps_dev>(c, "eps_dev", "", "eps_dev", "deviatoric strain, Eq. (4)", true);
  add<&R::shear_path>(c, "shear_path", "", "", "integral of |d eps_dev|, grows on reversal too", true);
  add<&R::nu>(c, "nu", "", "nu", "volume fraction", true);
  c.push_back({"P_star", "", "P*", "pressure times 2<r>/k", [](const R& r) { return r.state.P; },
               [](R& r, double v) { r.state.P = v; }, true});
  add<&R::s_dev>(c, "s_dev", "", "s_dev", "stress ratio, a norm", true);
  add<&R::s_par>(c, "s_par", "", "s_par", "signed stress ratio along the path's first shear direction", true);
  add<&R::F_dev>(c, "F_dev", "", "F_dev", "deviatoric fabric, a norm", true);
  add<&R::F_par>(c, "F_par", "", "F_par", "signed deviatoric fabric along the path's first shear direction", true);
  add_deviator<&LawState<double>::sigma>(c, "sigma_dev", "sigma'*",
                                         "deviatoric stress times 2<r>/k, compression positive");
  add_deviator<&LawState<double>::F>(c, "fabric_dev", "F'", "deviatoric fabric");
  add_bands<&RowBand::P>(c, "P_star", "P*");
  add_bands<&RowBand::s_dev>(c, "s_dev", "s_dev");
  add_bands<&RowBand::s_par>(c, "s_par", "s_par");
  add_bands<&RowBand::F_dev>(c, "F_dev", "F_dev");
  add_bands<&RowBand::F_par>(c, "F_par", "F_par");
  return c;
}

}  // namespace

const std::vector<Column<PredictedRow>>& prediction_columns() {
  static const auto columns = make_prediction_columns();
  return columns;
}

void write_prediction_series(const std::filesystem::path& file, const std::vector<PredictedRow>& rows) {
  write_durably(file, table_text(rows, prediction_columns()));
}

std::vector<PredictedRow> read_prediction_series(const std::filesystem::path& file) {
  CsvReader reader(file);
  const auto columns = matched(reader, prediction_columns());
  std::vector<PredictedRow> rows;
  std::vector<double> values;
  while (reader.next(values)) {
    PredictedRow row;
    row.state.sigma.setZero();
    row.state.F.setZero();
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isnan(values[i]) && columns[i]->required && columns[i]->name != "s_dev" && columns[i]->name != "s_par" &&
          columns[i]->name != "F_par") {
        reader.refuse(columns[i]->title(), "is empty; this column needs a number in every row");
      }
      columns[i]->set(row, values[i]);
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace grainlaw::predict
