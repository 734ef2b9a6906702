#pragma once
// The columns of the series that element tests and predictions leave on disk, declared once: titles, units, symbols
// and meaning (docs/formats.md is checked against these tables).

#include <array>
#include <string>
#include <vector>

#include "model/observation.hpp"
#include "predict/predict.hpp"

namespace grainlaw::app {

template <class Row>
struct Column {
  std::string name;           ///< title without unit
  std::string unit;           ///< empty: dimensionless
  std::string symbol;         ///< the paper's symbol
  std::string meaning;        ///< one line
  double (*get)(const Row&);  ///< NaN: undefined
  void (*set)(Row&, double);
  bool required = false;  ///< a data set that is to be fitted must have it

  std::string title() const { return unit.empty() ? name : name + "[" + unit + "]"; }  ///< as in the header line
};

/// Columns of a test's series, in the order of writing.
const std::vector<Column<Observation>>& observation_columns();

/// Columns of a prediction, in the order of writing.
const std::vector<Column<predict::PredictedRow>>& prediction_columns();

}  // namespace grainlaw::app
