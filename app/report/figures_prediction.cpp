#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "app/report/dem_series.hpp"
#include "app/report/figures.hpp"

namespace grainlaw::app::report {
namespace {

using predict::PredictedRow;

struct Predicted {
  const char* label;
  const char* difference;
  Quantity measured;
  double (*of)(const PredictedRow&);
  double predict::RowBand::*band;
};

constexpr std::array<Predicted, 3> kPredicted{
    {{"pressure {P}* [–]", "law − DEM: {P}* [–]", &Observation::P_star,
      [](const PredictedRow& row) { return row.state.P; }, &predict::RowBand::P},
     {"stress ratio {s}_{∥} [–]", "law − DEM: {s}_{∥} [–]", &Observation::s_par,
      [](const PredictedRow& row) { return row.s_par; }, &predict::RowBand::s_par},
     {"fabric {F}_{∥} [–]", "law − DEM: {F}_{∥} [–]", &Observation::F_par,
      [](const PredictedRow& row) { return row.F_par; }, &predict::RowBand::F_par}}};

template <class Row>
bool strain_grows(const std::vector<Row>& rows) {
  const auto less = [](const Row& a, const Row& b) { return a.eps_dev < b.eps_dev; };
  return std::is_sorted(rows.begin(), rows.end(), less);
}

/// What the figure is drawn over: deviatoric strain, or the length travelled when the path turns.
struct Abscissa {
  bool by_strain = true;

  double of(const Observation& row) const { return by_strain ? row.eps_dev : row.shear_path; }
  double of(const PredictedRow& row) const { return by_strain ? row.eps_dev : row.shear_path; }
};

Abscissa abscissa_of(const predict::PredictionFolder& prediction, const std::vector<TestRecord>& dem) {
  const bool grows =
      std::all_of(dem.begin(), dem.end(), [](const TestRecord& test) { return strain_grows(test.rows); }) &&
      std::all_of(prediction.curves.begin(), prediction.curves.end(),
                  [](const predict::PredictedCurve& drawn) { return strain_grows(drawn.prediction.rows); });
  return {grows};
}

/// Started from the law, a curve is the same for every seed and shown once; from measured values there is one for each.
std::vector<const predict::PredictedCurve*> shown_curves(const predict::PredictionFolder& prediction) {
  std::vector<const predict::PredictedCurve*> shown;
  for (const predict::PredictedCurve& drawn : prediction.curves) {
    const bool again = std::any_of(shown.begin(), shown.end(), [&](const predict::PredictedCurve* other) {
      return drawn.initial == predict::Initial::law && other->initial == predict::Initial::law && other->model == drawn.model;
    });
    if (!again) shown.push_back(&drawn);
  }
  return shown;
}

Series law_series(const predict::PredictedCurve& drawn) {
  const bool measured = drawn.initial == predict::Initial::measured;
  Series series;
  series.label = plain(to_string(drawn.model) + (measured ? ", from measured start" : ", from the law's start"));
  series.colour = drawn.model == Rung::reduced     ? Colour::green
                  : drawn.model == Rung::evolution ? Colour::vermillion
                                                   : Colour::blue;
  series.line = measured ? Line::dotted : Line::solid;
  return series;
}

Series predicted_line(const predict::PredictedCurve& drawn, const Predicted& quantity, const Abscissa& abscissa) {
  Series series = law_series(drawn);
  for (const PredictedRow& row : drawn.prediction.rows) {
    series.x.push_back(abscissa.of(row));
    series.y.push_back(quantity.of(row));
  }
  return series;
}

/// The curve whose bands are drawn: of the rung that the path needs, else of the richest, from the law's own start.
const predict::PredictedCurve* banded_curve(const predict::PredictionFolder& prediction,
                                   const std::vector<const predict::PredictedCurve*>& shown) {
  const predict::PredictedCurve* richest = nullptr;
  for (const predict::PredictedCurve* drawn : shown) {
    if (drawn->initial != predict::Initial::law) continue;
    if (richest == nullptr || richest->model != prediction.needed.rung) richest = drawn;
  }
  return richest;
}

void add_bands(const predict::PredictedCurve& drawn, const Predicted& quantity, Series& series) {
  series.bands.resize(2);
  for (const PredictedRow& row : drawn.prediction.rows) {
    series.bands[0].push_back(row.mean.*quantity.band);
    series.bands[1].push_back(row.single.*quantity.band);
  }
}

/// Row by row: the curve was computed at the rows of `test`.
Series difference_line(const predict::PredictedCurve& drawn, const TestRecord& test, const Predicted& quantity,
                       const Abscissa& abscissa) {
  Series series = law_series(drawn);
  series.line_width = 1;
  const std::size_t rows = std::min(drawn.prediction.rows.size(), test.rows.size());
  for (std::size_t i = 0; i < rows; ++i) {
    series.x.push_back(abscissa.of(test.rows[i]));
    series.y.push_back(quantity.of(drawn.prediction.rows[i]) - test.rows[i].*quantity.measured);
  }
  return series;
}

AxisStyle strain_axis(const Abscissa& abscissa) {
  AxisStyle style;
  style.label =
      notation(abscissa.by_strain ? "deviatoric strain {ε}_{dev} [–]" : "strain path length ∫|d{ε}_{dev}| [–]");
  style.include = 0;
  return style;
}

Panel value_panel(const predict::PredictionFolder& prediction, const std::vector<TestRecord>& dem, const Predicted& quantity,
                  const Abscissa& abscissa) {
  Panel panel;
  panel.x = strain_axis(abscissa);
  panel.y.label = notation(quantity.label);
  panel.y.include = 0;
  const auto seeds = seeds_of(dem);
  for (const TestRecord& test : dem) {
    const std::size_t seed = index_of(seeds, test.packing.seed);
    panel.series.push_back(dem_symbols(test, abscissa.by_strain ? &Observation::eps_dev : &Observation::shear_path,
                                       quantity.measured, 60, plain("DEM seed " + std::to_string(test.packing.seed)),
                                       seed % 2 == 0 ? Colour::blue : Colour::sky, marker_of(seed)));
  }
  const std::vector<const predict::PredictedCurve*> shown = shown_curves(prediction);
  const predict::PredictedCurve* const banded = banded_curve(prediction, shown);
  for (const predict::PredictedCurve* drawn : shown) {
    panel.series.push_back(predicted_line(*drawn, quantity, abscissa));
    if (drawn == banded) add_bands(*drawn, quantity, panel.series.back());
  }
  return panel;
}

Panel difference_panel(const predict::PredictionFolder& prediction, const std::vector<TestRecord>& dem,
                       const Predicted& quantity, const Abscissa& abscissa) {
  Panel panel;
  panel.x = strain_axis(abscissa);
  panel.y.label = notation(quantity.difference);
  panel.y.include = 0;
  panel.zero_line = true;
  const bool from_law =
      std::any_of(prediction.curves.begin(), prediction.curves.end(),
                  [](const predict::PredictedCurve& drawn) { return drawn.seed && drawn.initial == predict::Initial::law; });
  for (const predict::PredictedCurve& drawn : prediction.curves) {
    if (!drawn.seed || (from_law && drawn.initial != predict::Initial::law)) continue;
    for (const TestRecord& test : dem) {
      if (test.packing.seed == *drawn.seed) panel.series.push_back(difference_line(drawn, test, quantity, abscissa));
    }
  }
  return panel;
}

std::string in_folder(const predict::PredictionFolder& prediction, const std::string& file) {
  return "predictions/" + prediction.name + "/" + file;
}

}  // namespace

Figure prediction_figure(const predict::PredictionFolder& prediction, std::size_t index) {
  const std::vector<TestRecord> dem = dem_records(prediction);
  Figure figure;
  figure.id = fmt::format("prediction-{}", index + 1);
  figure.title = fmt::format("{}: {} from ν = {:.3f}, {} branch", prediction.name, kind_of(prediction.path),
                             prediction.path.nu, to_string(prediction.path.branch));
  figure.description =
      "Three panels over deviatoric strain: pressure, stress ratio and deviatoric fabric. Symbols are DEM runs on "
      "packings that the calibration never saw, lines the predictions of the law. Below them the differences.";
  const Text note =
      plain(fmt::format(" The path needs {}: {}. Bands, about that rung's curve from the law's start: {}.",
                        to_string(prediction.needed.rung), prediction.needed.why, prediction.bands));
  figure.caption =
      dem.empty() ? plain("No DEM run of this path; grainlaw predict with --dem makes them.")
                  : plain("DEM on packings that the calibration never saw (" + seed_count(dem) +
                          "). Below: the law, from its own start where there is one, minus DEM, row by row, a thin "
                          "line for each run.");
  figure.caption = figure.caption + note;
  figure.sources = {in_folder(prediction, "prediction.json"), in_folder(prediction, "*.csv")};
  if (!dem.empty()) figure.sources.push_back(in_folder(prediction, "dem/"));
  figure.columns = 3;
  figure.panel_height = dem.empty() ? 250 : 210;

  const Abscissa abscissa = abscissa_of(prediction, dem);
  for (const Predicted& quantity : kPredicted)
    figure.panels.push_back(value_panel(prediction, dem, quantity, abscissa));
  if (!dem.empty()) {
    for (const Predicted& quantity : kPredicted) {
      figure.panels.push_back(difference_panel(prediction, dem, quantity, abscissa));
    }
  }
  return figure;
}

}  // namespace grainlaw::app::report
