#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "app/report/figures.hpp"
#include "app/report/series.hpp"
#include "chain/rehearsals.hpp"
#include "model/files/path_json.hpp"

namespace grainlaw::app::report {
namespace {

using predict::Initial, predict::PredictedCurve, predict::PredictedRow, predict::PredictionFolder;

struct Predicted {
  const char *label, *symbol;
  double Observation::*measured;
  double (*of)(const PredictedRow&);
  double predict::RowBand::*band;
};

constexpr std::array<Predicted, 3> kPredicted{
    {{"pressure {P}* [–]", "{P}*", &Observation::P_star, [](const PredictedRow& row) { return row.state.P; },
      &predict::RowBand::P},
     {"stress ratio {s}_{∥} [–]", "{s}_{∥}", &Observation::s_par, [](const PredictedRow& row) { return row.s_par; },
      &predict::RowBand::s_par},
     {"fabric {F}_{∥} [–]", "{F}_{∥}", &Observation::F_par, [](const PredictedRow& row) { return row.F_par; },
      &predict::RowBand::F_par}}};
constexpr double kAboveJamming =
    1.005;  // of nu_c, from where P* over that of ISO unloading is no quotient of two small numbers
constexpr double kNoShear = 1e-9;  // length of a path of shear that there is none
constexpr std::size_t kLinePoints = 100, kSymbolsOfARun = 36;

bool strain_grows(const auto& rows) {
  return std::ranges::is_sorted(rows, {}, [](auto& row) { return row.eps_dev; });
}

/// Runs of one path by another engine than that of the prediction's own.
struct OtherRuns {
  std::string engine;
  std::vector<TestRecord> tests;
};

/// What ran the particles, as in SPEC; empty for data of others, which do not say.
std::string engine_of(const PredictionFolder& prediction) {
  if (!prediction.dem || !prediction.dem->spec.is_object()) return "";
  return prediction.dem->spec.value("engine", "grainlaw");
}

std::vector<OtherRuns> other_runs(const std::vector<PredictionFolder>& predictions, std::size_t index) {
  std::vector<OtherRuns> others;
  const PredictionFolder& own = predictions[index];
  for (const PredictionFolder& other : predictions) {
    const std::string engine = engine_of(other);
    if (engine.empty() || engine == engine_of(own) || path_to_json(other.path) != path_to_json(own.path)) continue;
    others.push_back({engine, chain::dem_records(other)});
  }
  return others;
}

std::string runs_in_words(const std::string& engine, std::size_t count) {
  return fmt::format("{}, {} {}", engine, count, count == 1 ? "run" : "runs");
}

/// What curves are drawn over: deviatoric strain, or the length of shear where it turns, with that of the volume where a part does not
/// shear, or nu where none does.
enum class Over { strain, shear, length, density };
constexpr std::array<const char*, 4> kOver{kStrainLabel, "strain path length ∫|d{ε}_{dev}| [–]",
                                           "strain path length ∫|d{ε}_{dev}| + ∫|d{ε}_{v}| [–]", kDensityLabel};

/// What a prediction's figure shows over what; and the unit of the pressure: where ISO unloading has one all along the path, that at the
/// same density, else none.
struct Shown {
  const PredictionFolder& prediction;
  const LawParameters<double>& parameters;
  std::vector<TestRecord> dem;
  std::vector<OtherRuns> others;
  Over over = Over::strain;
  bool by_ratio = true;
  std::vector<StraightSegment> segments = {};  ///< of over length
  std::vector<double> volume_before = {};      ///< length of the volume's path before each

  double x(const auto& row) const {
    if (over == Over::strain) return row.eps_dev;
    if (over == Over::shear) return row.shear_path;
    if (over == Over::density) return row.nu;
    const std::size_t k = std::min(static_cast<std::size_t>(row.segment), segments.size() - 1);
    return row.shear_path + volume_before[k] + std::abs(std::log(row.nu / segments[k].nu_start));
  }
  double unit(const Predicted& quantity, double nu) const {
    return by_ratio && &quantity == kPredicted.data() ? parameters.isotropic.P_star(nu) : 1;
  }

  Panel panel(const char* label) const {
    Panel panel = panel_of("", kOver[static_cast<std::size_t>(over)], label);
    if (over != Over::density) panel.x.include = 0;
    return panel;
  }
};

/// Where a part of a given path does not shear.
void choose_length(const Path& path, Shown& shown) {
  const std::vector<StraightSegment> segments = resolve(path);
  std::vector<double> before{0};
  for (const StraightSegment& segment : segments)
    before.push_back(before.back() + segment.length * std::abs(segment.eps_vol_rate()));
  if (std::ranges::all_of(segments, shears, &StraightSegment::direction)) return;
  shown.over = Over::length;
  shown.segments = segments;
  shown.volume_before = before;
}

Shown shown_of(const std::vector<PredictionFolder>& predictions, std::size_t index, const CalibratedLaw& law) {
  const PredictionFolder& prediction = predictions[index];
  Shown shown{prediction, law.parameters, chain::dem_records(prediction), other_runs(predictions, index)};
  std::vector<TestRecord> all = shown.dem;
  for (const OtherRuns& other : shown.others) all.insert(all.end(), other.tests.begin(), other.tests.end());
  bool grows = std::ranges::all_of(all, [](const TestRecord& test) { return strain_grows(test.rows); });
  double sheared = 0;
  for (const PredictedCurve& drawn : prediction.curves) {
    grows = grows && strain_grows(drawn.prediction.rows);
    for (const PredictedRow& row : drawn.prediction.rows) sheared = std::max(sheared, row.shear_path);
  }
  shown.over = sheared <= kNoShear ? Over::density : grows ? Over::strain : Over::shear;
  if (sheared > kNoShear && !law_decides(prediction.path)) choose_length(prediction.path, shown);
  const double least = kAboveJamming * law.parameters.isotropic.pressure.nu_c;
  for (const PredictedCurve& drawn : prediction.curves) {
    for (const PredictedRow& row : drawn.prediction.rows) shown.by_ratio = shown.by_ratio && row.nu > least;
  }
  for (const TestRecord& test : all) {
    for (const Observation& row : test.rows) shown.by_ratio = shown.by_ratio && row.nu > least;
  }
  shown.by_ratio = shown.by_ratio && has_values(law, density_curve("P_star"));
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

/// How a curve is drawn: the recommended one in full, others only where their toggle is chosen.
Series law_line(const PredictedCurve& drawn, const PredictedCurve* recommended, double width) {
  const bool measured = drawn.initial == Initial::measured;
  const bool first = recommended != nullptr && drawn.model == recommended->model && !measured;
  Series line = line_of(plain(to_string(drawn.model) + (measured ? ", from each run's measured start"
                                                        : first  ? ", recommended"
                                                                 : "")),
                        colour_of(drawn.model), measured ? Line::dotted : Line::solid, width);
  if (!first) {
    line.toggle = measured ? "measured start" : to_string(drawn.model);
    line.initially_hidden = recommended != nullptr;
  }
  return line;
}

/// From a measured start the recommended rung alone is drawn; the table has them all.
bool is_drawn(const PredictedCurve& drawn, const PredictedCurve* recommended) {
  return drawn.initial == Initial::law || recommended == nullptr || drawn.model == recommended->model;
}

Panel value_panel(const Shown& shown, const Predicted& quantity) {
  const bool ratio = shown.by_ratio && &quantity == kPredicted.data();
  Panel panel = shown.panel(ratio ? "{P}*/{P}*_{ISO}({ν}) [–]" : quantity.label);
  if (ratio) {
    panel.y.include = 1;
  } else {
    panel.y.include = 0;
  }
  const auto x = [&](const auto& row) { return shown.x(row); };
  const auto add_runs = [&](const std::string& engine, const std::vector<TestRecord>& tests, Colour colour,
                            Marker marker) {
    for (const TestRecord& test : tests) {
      panel.series.push_back(through(open_symbols(plain(runs_in_words(engine, tests.size())), colour, marker, 2),
                                     symbol_rows(test, kSymbolsOfARun), x, [&](const Observation& row) {
                                       return row.*quantity.measured / shown.unit(quantity, row.nu);
                                     }));
    }
  };
  for (const OtherRuns& other : shown.others)
    add_runs("DEM by " + other.engine, other.tests, Colour::orange, Marker::square);
  add_runs(shown.others.empty() ? "DEM" : "DEM by " + engine_of(shown.prediction), shown.dem, Colour::grey,
           Marker::circle);
  const std::vector<const PredictedCurve*> curves = distinct_curves(shown.prediction);
  const PredictedCurve* const banded = banded_curve(shown.prediction, curves);
  for (const PredictedCurve* drawn : curves) {
    if (!is_drawn(*drawn, banded)) continue;
    const std::vector<PredictedRow> rows = thinned(drawn->prediction.rows, kLinePoints);
    Series& line = panel.series.emplace_back(
        through(law_line(*drawn, banded, drawn == banded ? 2.4 : 1.2), rows, x,
                [&](const PredictedRow& row) { return quantity.of(row) / shown.unit(quantity, row.nu); }));
    if (drawn != banded) continue;
    line.bands.resize(2);
    for (const PredictedRow& row : rows) {
      line.bands[0].push_back(row.mean.*quantity.band / shown.unit(quantity, row.nu));
      line.bands[1].push_back(row.single.*quantity.band / shown.unit(quantity, row.nu));
    }
  }
  return panel;
}

/// Whether the curve has a band of a single run, in whose half width its residual counts.
bool has_band(const PredictionFolder& prediction) {
  return std::ranges::any_of(prediction.curves, [](const PredictedCurve& drawn) {
    return std::ranges::any_of(drawn.prediction.rows,
                               [](const PredictedRow& row) { return row.single.s_par > 0 || row.single.P > 0; });
  });
}

/// DEM minus law row by row, in half widths of the curve's own band of a single run where it has one. Such a curve was computed at the
/// rows of the run of its seed.
Panel residual_panel(const Shown& shown, const Predicted& quantity) {
  const bool banded = has_band(shown.prediction);
  const std::string label = quantity.symbol + std::string(banded ? ": (DEM − law)/band" : ": DEM − law [–]");
  Panel panel = shown.panel(label.c_str());
  panel.zero_line = true;
  const PredictedCurve* const recommended = banded_curve(shown.prediction, distinct_curves(shown.prediction));
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  for (const PredictedCurve& drawn : shown.prediction.curves) {
    if (!drawn.seed || !is_drawn(drawn, recommended)) continue;
    for (const TestRecord& test : shown.dem) {
      if (test.packing.seed != *drawn.seed) continue;
      Series& line = panel.series.emplace_back(law_line(drawn, recommended, 1));
      const std::size_t rows = std::min(drawn.prediction.rows.size(), test.rows.size()),
                        stride = std::max<std::size_t>(1, rows / kLinePoints);
      for (std::size_t i = 0; i < rows; i += stride) {
        const PredictedRow& row = drawn.prediction.rows[i];
        const double band = banded ? row.single.*quantity.band : 1;
        if (!(band > 0)) continue;
        line.x.push_back(shown.x(test.rows[i]));
        line.y.push_back((test.rows[i].*quantity.measured - quantity.of(row)) / band);
        begin = std::min(begin, line.x.back());
        end = std::max(end, line.x.back());
      }
    }
  }
  if (banded && begin <= end) {
    Series inside;
    inside.x = {begin, end};
    inside.y = {0, 0};
    inside.bands = {{1, 1}};
    inside.colour = Colour::grey;
    panel.series.insert(panel.series.begin(), inside);
  }
  return panel;
}

}  // namespace

std::string prediction_id(std::size_t index) { return fmt::format("prediction-{}", index + 1); }

Figure prediction_figure(const chain::ReportInput& input, std::size_t index) {
  const PredictionFolder& prediction = input.predictions[index];
  const Shown shown = shown_of(input.predictions, index, input.calibration.law);
  const bool compared = !shown.dem.empty();
  std::vector<Panel> panels;
  for (const Predicted& quantity : kPredicted) panels.push_back(value_panel(shown, quantity));
  for (const Predicted& quantity : kPredicted) {
    if (compared) panels.push_back(residual_panel(shown, quantity));
  }
  const std::string folder = "predictions/" + prediction.name + "/";
  std::vector<std::string> sources{folder + "prediction.json", folder + "*.csv"};
  if (compared) sources.push_back(folder + "dem/");
  const bool fitted = std::ranges::any_of(shown.dem, [&](const TestRecord& run) {
    return std::ranges::any_of(input.tests,
                               [&](const TestRecord& test) { return chain::is_fitted(run.packing, test); });
  });
  const std::string runs =
      compared                       ? fmt::format("DEM on packings {} ({}).",
                             fitted ? "of which some were fitted, too" : "that the calibration never saw",
                                                   seed_count(shown.dem))
      : law_decides(prediction.path) ? "No DEM run of this path, whose strain is the law's."
                                     : "No DEM run of this path; grainlaw predict with --dem makes them.";
  const std::string thick = banded_curve(prediction, distinct_curves(prediction)) == nullptr
                                ? "Lines: each from its run's measured start."
                                : fmt::format("Thick: {}, recommended: {}.", to_string(prediction.recommended.rung),
                                              prediction.recommended.why);
  const std::string residual =
      !compared ? ""
      : has_band(prediction)
          ? " Below: DEM − law in half widths of the 95 % band of a single run, within the grey strip as expected."
          : " Below: DEM − law; there is no band of a single run.";
  return {
      .id = prediction_id(index),
      .title = fmt::format("{}: {} from ν = {:.3f}, {} branch", prediction.name, kind_of(prediction.path),
                           prediction.path.nu, to_string(prediction.path.branch)),
      .description = fmt::format(
          "Three panels over {}: pressure, stress ratio and deviatoric fabric. Symbols are DEM runs, the thick line "
          "the recommended prediction of the law with its bands. Below each the residuals.",
          to_plain(notation(kOver[static_cast<std::size_t>(shown.over)]))),
      .caption = plain(fmt::format("{}{} {} Bands: {}. The path needs {}: {}.", runs, residual, thick, prediction.bands,
                                   to_string(prediction.needed.rung), prediction.needed.why)),
      .sources = sources,
      .panels = panels,
      .columns = 3,
      .panel_height = compared ? 200.0 : 250.0};
}

}  // namespace grainlaw::app::report
