#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/report/figures.hpp"
#include "app/report/series.hpp"

namespace grainlaw::app::report {
namespace {

using predict::Initial, predict::PredictedCurve, predict::PredictedRow, predict::PredictionFolder;

struct Predicted {
  const char* label;
  const char* difference;
  double Observation::*measured;
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

/// What a prediction's figure shows over what: deviatoric strain, or the length travelled when the path turns.
struct Shown {
  const PredictionFolder& prediction;
  std::vector<TestRecord> dem;
  bool by_strain = true;

  double x(const Observation& row) const { return by_strain ? row.eps_dev : row.shear_path; }
  double x(const PredictedRow& row) const { return by_strain ? row.eps_dev : row.shear_path; }

  Panel panel(const char* label) const {
    Panel panel = panel_of("", by_strain ? kStrainLabel : "strain path length ∫|d{ε}_{dev}| [–]", label);
    panel.x.include = panel.y.include = 0;
    return panel;
  }
};

Shown shown_of(const PredictionFolder& prediction) {
  Shown shown{prediction, chain::dem_records(prediction)};
  shown.by_strain =
      std::all_of(shown.dem.begin(), shown.dem.end(), [](const TestRecord& test) { return strain_grows(test.rows); }) &&
      std::all_of(prediction.curves.begin(), prediction.curves.end(),
                  [](const PredictedCurve& drawn) { return strain_grows(drawn.prediction.rows); });
  return shown;
}

/// Started from the law, a curve is the same for every seed and shown once; from measured values there is one for each.
std::vector<const PredictedCurve*> distinct_curves(const PredictionFolder& prediction) {
  std::vector<const PredictedCurve*> distinct;
  for (const PredictedCurve& drawn : prediction.curves) {
    const bool again = std::any_of(distinct.begin(), distinct.end(), [&](const PredictedCurve* other) {
      return drawn.initial == Initial::law && other->initial == Initial::law && other->model == drawn.model;
    });
    if (!again) distinct.push_back(&drawn);
  }
  return distinct;
}

/// The curve that stands out, with its bands: of the recommended rung, else of the richest, from the law's own start.
const PredictedCurve* banded_curve(const PredictionFolder& prediction,
                                   const std::vector<const PredictedCurve*>& curves) {
  const PredictedCurve* richest = nullptr;
  for (const PredictedCurve* drawn : curves) {
    if (drawn->initial != Initial::law) continue;
    if (richest == nullptr || richest->model != prediction.recommended.rung) richest = drawn;
  }
  return richest;
}

Series law_line(const PredictedCurve& drawn, double width = 1.8) {
  const bool measured = drawn.initial == Initial::measured;
  const Colour colour = drawn.model == Rung::reduced     ? Colour::green
                        : drawn.model == Rung::evolution ? Colour::vermillion
                                                         : Colour::blue;
  return line_of(plain(to_string(drawn.model) + (measured ? ", from measured start" : ", from the law's start")),
                 colour, measured ? Line::dotted : Line::solid, width);
}

Panel value_panel(const Shown& shown, const Predicted& quantity) {
  Panel panel = shown.panel(quantity.label);
  const auto x = [&](const auto& row) { return shown.x(row); };
  const auto seeds = seeds_of(shown.dem);
  for (const TestRecord& test : shown.dem) {
    const std::size_t seed = index_of(seeds, test.packing.seed);
    panel.series.push_back(through(open_symbols(plain("DEM seed " + std::to_string(test.packing.seed)),
                                                seed % 2 == 0 ? Colour::blue : Colour::sky, marker_of(seed), 2),
                                   symbol_rows(test, 60), x, quantity.measured));
  }
  const std::vector<const PredictedCurve*> curves = distinct_curves(shown.prediction);
  const PredictedCurve* const banded = banded_curve(shown.prediction, curves);
  for (const PredictedCurve* drawn : curves) {
    Series& line = panel.series.emplace_back(
        through(law_line(*drawn, drawn == banded ? 2.4 : 1.2), drawn->prediction.rows, x, quantity.of));
    if (drawn != banded) continue;
    line.bands.resize(2);
    for (const PredictedRow& row : drawn->prediction.rows) {
      line.bands[0].push_back(row.mean.*quantity.band);
      line.bands[1].push_back(row.single.*quantity.band);
    }
  }
  return panel;
}

/// Law minus DEM row by row: such a curve was computed at the rows of the run of its seed.
Panel difference_panel(const Shown& shown, const Predicted& quantity) {
  Panel panel = shown.panel(quantity.difference);
  panel.zero_line = true;
  const auto& curves = shown.prediction.curves;
  const bool from_law = std::any_of(curves.begin(), curves.end(), [](const PredictedCurve& drawn) {
    return drawn.seed && drawn.initial == Initial::law;
  });
  for (const PredictedCurve& drawn : curves) {
    if (!drawn.seed || (from_law && drawn.initial != Initial::law)) continue;
    for (const TestRecord& test : shown.dem) {
      if (test.packing.seed != *drawn.seed) continue;
      Series& line = panel.series.emplace_back(law_line(drawn, 1));
      for (std::size_t i = 0; i < std::min(drawn.prediction.rows.size(), test.rows.size()); ++i) {
        line.x.push_back(shown.x(test.rows[i]));
        line.y.push_back(quantity.of(drawn.prediction.rows[i]) - test.rows[i].*quantity.measured);
      }
    }
  }
  return panel;
}

}  // namespace

Figure prediction_figure(const predict::PredictionFolder& prediction, std::size_t index) {
  const Shown shown = shown_of(prediction);
  const bool compared = !shown.dem.empty();
  std::vector<Panel> panels;
  for (const Predicted& quantity : kPredicted) panels.push_back(value_panel(shown, quantity));
  for (const Predicted& quantity : kPredicted) {
    if (compared) panels.push_back(difference_panel(shown, quantity));
  }
  const std::string folder = "predictions/" + prediction.name + "/";
  std::vector<std::string> sources{folder + "prediction.json", folder + "*.csv"};
  if (compared) sources.push_back(folder + "dem/");
  const std::string runs =
      compared ? "DEM on packings that the calibration never saw (" + seed_count(shown.dem) +
                     "). Below: the law, from its own start where there is one, minus DEM, row by row, a thin line for "
                     "each run."
               : "No DEM run of this path; grainlaw predict with --dem makes them.";
  return {
      .id = fmt::format("prediction-{}", index + 1),
      .title = fmt::format("{}: {} from ν = {:.3f}, {} branch", prediction.name, kind_of(prediction.path),
                           prediction.path.nu, to_string(prediction.path.branch)),
      .description =
          "Three panels over deviatoric strain: pressure, stress ratio and deviatoric fabric. Symbols are DEM runs "
          "on packings that the calibration never saw, lines the predictions of the law. Below them the differences.",
      .caption =
          plain(fmt::format("{} By what it contains the path needs {}: {}. Recommended, the thick line: {}, {}. Bands, "
                            "about that rung's curve from the law's start: {}.",
                            runs, to_string(prediction.needed.rung), prediction.needed.why,
                            to_string(prediction.recommended.rung), prediction.recommended.why, prediction.bands)),
      .sources = sources,
      .panels = panels,
      .columns = 3,
      .panel_height = compared ? 210.0 : 250.0};
}

}  // namespace grainlaw::app::report
