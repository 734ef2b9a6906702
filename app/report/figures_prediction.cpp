#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/report/dem_series.hpp"
#include "app/report/figures.hpp"

namespace grainlaw::app::report {
namespace {

using predict::PredictedRow;

struct Predicted {
  const char* label;
  Quantity measured;
  double (*of)(const PredictedRow&);
};

constexpr std::array<Predicted, 3> kQuantities{
    {{"pressure {P}* [–]", &Observation::P_star, [](const PredictedRow& row) { return row.state.P; }},
     {"stress ratio {s}_{∥} [–]", &Observation::s_par, [](const PredictedRow& row) { return row.s_par; }},
     {"fabric {F}_{∥} [–]", &Observation::F_par, [](const PredictedRow& row) { return row.F_par; }}}};

/// Paths that return (ISO after shear, reversals) need the length travelled, simple ones the strain of the figures.
bool strain_grows(const PredictionCase& prediction) {
  for (const TestRecord& test : prediction.dem) {
    for (std::size_t i = 1; i < test.rows.size(); ++i) {
      if (test.rows[i].eps_dev < test.rows[i - 1].eps_dev) return false;
    }
  }
  for (const PredictedCurve& drawn : prediction.curves) {
    for (std::size_t i = 1; i < drawn.rows.size(); ++i) {
      if (drawn.rows[i].eps_dev < drawn.rows[i - 1].eps_dev) return false;
    }
  }
  return true;
}

Series predicted_line(const PredictedCurve& drawn, const Predicted& quantity, bool by_strain) {
  Series series;
  const bool reduced = drawn.model == "reduced", measured = drawn.initial == "measured";
  series.label = plain(drawn.model + (measured ? ", from the measured start" : ", from the law's start"));
  series.colour = reduced ? Colour::green : Colour::vermillion;
  series.line = measured ? Line::dotted : Line::solid;
  for (const PredictedRow& row : drawn.rows) {
    series.x.push_back(by_strain ? row.eps_dev : row.shear_path);
    series.y.push_back(quantity.of(row));
  }
  return series;
}

}  // namespace

Figure prediction_figure(const PredictionCase& prediction, std::size_t index) {
  Figure figure;
  figure.id = fmt::format("prediction-{}", index + 1);
  figure.title = fmt::format("{}: {} from ν = {:.4g}, {} branch", prediction.name, kind_of(prediction.path),
                             prediction.path.nu, to_string(prediction.path.branch));
  figure.description =
      "Three panels over deviatoric strain: pressure, stress ratio and deviatoric fabric. Symbols are DEM runs on packings "
      "that the calibration never saw, lines the predictions of the law.";
  figure.caption = prediction.dem.empty()
                       ? plain("No DEM run of this path; grainlaw predict with --dem makes them.")
                       : plain("DEM on packings that the calibration never saw (" + seed_count(prediction.dem) + ").");
  for (const PredictedCurve& drawn : prediction.curves) figure.sources.push_back(drawn.file);
  figure.sources.insert(figure.sources.end(), prediction.dem_files.begin(), prediction.dem_files.end());
  figure.columns = 3;
  figure.panel_height = 250;

  const bool by_strain = strain_grows(prediction);
  const auto seeds = seeds_of(prediction.dem);
  for (const Predicted& quantity : kQuantities) {
    Panel panel;
    panel.x.label = notation(by_strain ? "deviatoric strain {ε}_{dev} [–]" : "strain path length ∫|d{ε}_{dev}| [–]");
    panel.x.include = 0;
    panel.y.label = notation(quantity.label);
    panel.y.include = 0;
    for (const TestRecord& test : prediction.dem) {
      const std::size_t seed = index_of(seeds, test.packing.seed);
      panel.series.push_back(dem_symbols(test, by_strain ? &Observation::eps_dev : &Observation::shear_path,
                                         quantity.measured, 60, plain("DEM seed " + std::to_string(test.packing.seed)),
                                         seed % 2 == 0 ? Colour::blue : Colour::sky, marker_of(seed)));
    }
    for (const PredictedCurve& drawn : prediction.curves) {
      panel.series.push_back(predicted_line(drawn, quantity, by_strain));
    }
    figure.panels.push_back(panel);
  }
  return figure;
}

}  // namespace grainlaw::app::report
