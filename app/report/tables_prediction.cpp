#include "app/report/tables.hpp"

#include <algorithm>

#include "app/report/table_cells.hpp"

namespace grainlaw::app::report {
Table prediction_summary(const std::vector<predict::PredictionFolder>& predictions) {
  Table table;
  table.caption = "Prediction minus DEM, mean over seeds: bias, and RMS over max|DEM|";
  table.source = "predictions/*/comparison.json";
  table.columns = {words(plain("path")),
                   words(plain("model")),
                   words(plain("start")),
                   quantity(notation("{P}* bias")),
                   quantity(notation("{P}* RMS [%]")),
                   quantity(notation("{s}_{∥} bias")),
                   quantity(notation("{s}_{∥} RMS [%]")),
                   quantity(notation("{F}_{∥} bias")),
                   quantity(notation("{F}_{∥} RMS [%]"))};
  for (const predict::PredictionFolder& prediction : predictions) {
    for (const predict::CurveComparison& entry : prediction.comparisons) {
      if (entry.seed) continue;
      std::vector<Text> row{plain(prediction.name), plain(to_string(entry.model)), plain(to_string(entry.initial))};
      for (const char* name : {"P_star", "s_par", "F_par"}) {
        const auto& all = entry.comparison.quantities;
        const auto found = std::find_if(all.begin(), all.end(), [&](const auto& q) { return q.quantity == name; });
        row.push_back(plain(found == all.end() ? kNoNumber : significant_padded(found->bias, 2)));
        row.push_back(plain(found == all.end() ? kNoNumber : fixed(100 * found->normalised_rms, 1)));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

Table prediction_table(const predict::PredictionFolder& prediction) {
  Table table;
  table.caption = prediction.name + ": prediction minus DEM, run by run";
  table.source = "predictions/" + prediction.name + "/comparison.json";
  table.columns = {words(plain("model")),
                   words(plain("start")),
                   quantity(plain("DEM seed")),
                   words(plain("quantity")),
                   quantity(plain("rows")),
                   quantity(plain("bias")),
                   quantity(plain("RMS")),
                   quantity(plain("RMS/max|DEM| [%]")),
                   quantity(plain("largest")),
                   quantity(notation("at {ε}_{dev}")),
                   quantity(notation("at {ν}")),
                   quantity(plain("in band of the mean [%]")),
                   quantity(plain("of a single run [%]"))};
  for (const predict::CurveComparison& entry : prediction.comparisons) {
    for (const predict::QuantityComparison& q : entry.comparison.quantities) {
      table.rows.push_back({plain(to_string(entry.model)), plain(to_string(entry.initial)),
                            plain(entry.seed ? std::to_string(*entry.seed) : "mean"), plain(q.quantity),
                            plain(std::to_string(q.rows)), number(q.bias, 3), number(q.rms, 3),
                            plain(fixed(100 * q.normalised_rms, 2)), number(q.largest, 3),
                            number(q.largest_at_eps_dev, 3), plain(fixed(q.largest_at_nu, 3)),
                            plain(fixed(100 * q.coverage_mean, 0)), plain(fixed(100 * q.coverage_single, 0))});
    }
  }
  return table;
}

Table solver_table(const std::vector<predict::PredictionFolder>& predictions) {
  Table table;
  table.caption = "What the integration of the law took";
  table.source = "predictions/*/prediction.json";
  table.columns = {words(plain("path")),
                   words(plain("model")),
                   words(plain("start")),
                   quantity(plain("DEM seed")),
                   quantity(plain("rows")),
                   quantity(plain("steps")),
                   quantity(plain("right-hand sides")),
                   quantity(plain("failed error tests")),
                   quantity(plain("restarts")),
                   quantity(plain("seconds"))};
  for (const predict::PredictionFolder& prediction : predictions) {
    for (const predict::PredictedCurve& drawn : prediction.curves) {
      const predict::SolverStatistics& s = drawn.prediction.statistics;
      table.rows.push_back({plain(prediction.name), plain(to_string(drawn.model)), plain(to_string(drawn.initial)),
                            plain(drawn.seed ? std::to_string(*drawn.seed) : kNoNumber),
                            plain(std::to_string(drawn.prediction.rows.size())), plain(std::to_string(s.steps)),
                            plain(std::to_string(s.rhs_evaluations)), plain(std::to_string(s.error_test_failures)),
                            plain(std::to_string(s.restarts)), number(s.seconds, 2)});
    }
  }
  return table;
}

}  // namespace grainlaw::app::report
