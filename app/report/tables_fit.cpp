#include "app/report/tables.hpp"

#include "app/report/table_cells.hpp"

namespace grainlaw::app::report {
namespace {

double percent(double part, double whole) { return 100 * part / whole; }

}  // namespace

Table stage_table(const fit::Calibration& calibration) {
  Table table;
  table.caption = "Stages of the fit";
  table.source = "calibration.json";
  table.columns = {words(plain("stage")),         quantity(plain("free")),          quantity(plain("residuals")),
                   quantity(plain("iterations")), quantity(plain("cost at start")), quantity(plain("cost at end")),
                   quantity(plain("seconds")),    words(plain("window")),           words(plain("termination"))};
  for (const fit::Stage& stage : calibration.stages) {
    table.rows.push_back({plain(stage.name), plain(std::to_string(stage.free_parameters)),
                          plain(std::to_string(stage.residuals)), plain(std::to_string(stage.iterations)),
                          number(stage.initial_cost), number(stage.final_cost), number(stage.seconds, 2),
                          plain(stage.window), plain(stage.termination)});
  }
  return table;
}

Table residual_table(const fit::Calibration& calibration) {
  Table table;
  table.caption = "Misfit of the coupled fits per test: model minus DEM";
  table.source = "calibration.json";
  table.columns = {words(plain("stage")),
                   words(plain("test")),
                   words(plain("quantity")),
                   words(plain("fitted")),
                   quantity(plain("rows")),
                   quantity(plain("left out")),
                   quantity(plain("RMS")),
                   quantity(plain("bias")),
                   quantity(plain("RMS/max|DEM| [%]")),
                   quantity(plain("bias/max|DEM| [%]"))};
  for (const fit::Stage& stage : calibration.stages) {
    if (stage.name != "evolution" && stage.name != "memory") continue;
    for (const fit::TestResidual& r : stage.tests) {
      table.rows.push_back(
          {plain(stage.name), plain(r.test), plain(r.quantity), plain(r.in_cost ? "yes" : "shown only"),
           plain(std::to_string(r.rows)), plain(std::to_string(r.rows_excluded)), number(r.rms, 3), number(r.bias, 3),
           plain(fixed(percent(r.rms, r.max_abs_data), 2)), plain(fixed(percent(r.bias, r.max_abs_data), 2))});
    }
  }
  return table;
}

}  // namespace grainlaw::app::report
