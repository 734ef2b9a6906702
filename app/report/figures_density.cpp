#include <algorithm>
#include <cmath>
#include <vector>

#include "app/report/dem_series.hpp"
#include "app/report/figures.hpp"
#include "app/report/law_curves.hpp"
#include "model/density_laws.hpp"

namespace grainlaw::app::report {
namespace {

using Law = StateLaw<double>;

constexpr int kRowsShown = 60;

/// Curves of one quantity over density: ours and published, isotropic and steady. Ours only where all `groups` of
/// parameters that it reads are identified.
template <class Function>
void add_state_curves(Panel& panel, const ReportInput& input, double from, double to,
                      const std::vector<const char*>& groups, const Function& of) {
  const LawParameters<double> published = published_parameters();
  const auto add = [&](const char* label, const Law& law, Colour colour, Line line) {
    panel.series.push_back(curve(notation(label), colour, line, from, to, [&](double nu) { return of(law, nu); }));
  };
  const auto known = [&](const std::string& prefix) {
    return std::all_of(groups.begin(), groups.end(),
                       [&](const char* group) { return has_values(input.calibration.law, prefix + group); });
  };
  add("ISO, published", published.isotropic, Colour::ink, Line::dashed);
  add("steady D2, published", published.steady, Colour::purple, Line::dashed);
  const LawParameters<double>& ours = input.calibration.law.parameters;
  if (known("")) add("ISO, fitted", ours.isotropic, Colour::blue, Line::solid);
  if (known("steady_")) add("steady D2, fitted", ours.steady, Colour::vermillion, Line::solid);
}

void add_isotropic_symbols(Panel& panel, const ReportInput& input, Quantity y) {
  const auto seeds = seeds_of(input.tests);
  for (const TestRecord& test : input.tests) {
    if (!is_isotropic_unloading(test)) continue;
    const Text label = plain("ISO unloading, DEM seed " + std::to_string(test.packing.seed));
    panel.series.push_back(dem_symbols(test, &Observation::nu, y, kRowsShown, label, Colour::blue,
                                       marker_of(index_of(seeds, test.packing.seed))));
  }
}

Series steady_symbols(const std::vector<fit::ShearFit>& fits, Mode mode, double fit::ShearFit::*y, Colour colour,
                      Marker marker) {
  Series series;
  series.label = plain("steady " + to_string(mode) + ", DEM (mean per run)");
  series.colour = colour;
  series.marker = marker;
  series.marker_size = 3.2;
  for (const fit::ShearFit& shear : fits) {
    if (shear.mode != mode) continue;
    series.x.push_back(shear.nu);
    series.y.push_back(shear.*y);
  }
  return series;
}

void add_steady_symbols(Panel& panel, const ReportInput& input, double fit::ShearFit::*y) {
  panel.series.push_back(steady_symbols(input.calibration.shear, Mode::D2, y, Colour::vermillion, Marker::square));
  for (const fit::Description& d : input.modes.descriptions) {
    if (d.name != "D3") continue;
    panel.series.push_back(steady_symbols(d.calibration.shear, Mode::D3, y, Colour::green, Marker::diamond));
  }
}

struct Range {
  double from, to;
};

/// From a little below jamming, where the laws begin, to the densest row.
Range shown_range(const ReportInput& input) {
  const auto& c = input.calibration;
  double from = c.law.parameters.isotropic.pressure.nu_c;
  if (has_values(c.law, "steady_pressure")) from = std::min(from, c.law.parameters.steady.pressure.nu_c);
  return {std::min(from, c.law.range.nu_max - 0.01), c.law.range.nu_max};
}

Panel density_panel(const char* label, const Range& range) {
  Panel panel;
  panel.x.label = notation("volume fraction {ν} [–]");
  panel.x.from = range.from - 0.005;
  panel.x.to = range.to + 0.005;
  panel.y.label = notation(label);
  return panel;
}

}  // namespace

Figure density_figure(const ReportInput& input) {
  const Range range = shown_range(input);
  Figure figure;
  figure.id = "density";
  figure.title = "Pressure, coordination and rattlers against volume fraction";
  figure.description =
      "Three panels over volume fraction: dimensionless pressure and corrected coordination number rise, the "
      "fraction of rattlers falls. Symbols are DEM data, solid lines the fitted equations 14, 11 and 12, dashed "
      "lines the published ones.";
  figure.caption = notation(
      "{P}* with Eq. 14, {C}* with Eq. 11, {φ}_{r} with Eq. 12. Every run shows about 60 of its rows. "
      "Dashed: Table 2 of the paper.");
  figure.sources = {"dataset/", "calibration.json", "parameters.json"};
  figure.columns = 3;
  figure.panel_height = 270;

  Panel pressure = density_panel("pressure {P}* [–]", range);
  pressure.y.include = 0;
  add_isotropic_symbols(pressure, input, &Observation::P_star);
  add_steady_symbols(pressure, input, &fit::ShearFit::P_star);
  add_state_curves(pressure, input, range.from, range.to, {"pressure", "coordination", "rattlers"},
                   [](const Law& law, double nu) { return law.P_star(nu); });

  Panel coordination = density_panel("coordination number {C}* [–]", range);
  coordination.y.from = 5.5;  // below jamming the few particles with four contacts say nothing
  add_isotropic_symbols(coordination, input, &Observation::C_star);
  add_steady_symbols(coordination, input, &fit::ShearFit::C_star);
  add_state_curves(coordination, input, range.from, range.to, {"coordination"},
                   [](const Law& law, double nu) { return law.coordination.C_star(nu); });

  Panel rattlers = density_panel("rattler fraction {φ}_{r} [–]", range);
  rattlers.y.from = 0;
  rattlers.y.to = 0.3;
  add_isotropic_symbols(rattlers, input, &Observation::rattler_fraction);
  add_steady_symbols(rattlers, input, &fit::ShearFit::rattler_fraction);
  add_state_curves(rattlers, input, range.from, range.to, {"rattlers", "coordination"},
                   [](const Law& law, double nu) { return law.rattlers.fraction(nu, law.coordination.nu_c); });

  figure.panels = {pressure, coordination, rattlers};
  return figure;
}

Figure scaled_density_figure(const ReportInput& input) {
  const Range range = shown_range(input);
  const LawParameters<double>& ours = input.calibration.law.parameters;
  const LawParameters<double> published = published_parameters();
  const auto seeds = seeds_of(input.tests);
  Figure figure;
  figure.id = "scaled";
  figure.title = "Scaled pressure, overlap and fabric trace on isotropic unloading";
  figure.description =
      "Three panels over volume fraction, all rising: pressure divided by density and coordination, mean overlap of "
      "contacts, trace of the fabric tensor. Symbols are DEM data, solid lines the fitted equations, dashed lines "
      "the published ones.";
  figure.caption = notation(
      "Scaled pressure {P}* {ν}_{c}/({ν}{C}) with Eq. 15, mean overlap with Eq. 13 ({D} ln({ν}/{ν}_{c})), "
      "{F}_{v} with {g}_{3}{ν}{C}.");
  figure.sources = {"dataset/", "parameters.json"};
  figure.columns = 3;
  figure.panel_height = 230;

  const auto add_curves = [&](Panel& panel, bool known, const auto& of) {
    panel.series.push_back(curve(notation("published"), Colour::ink, Line::dashed, range.from, range.to,
                                 [&](double nu) { return of(published, nu); }));
    if (!known) return;
    panel.series.push_back(curve(notation("fitted"), Colour::blue, Line::solid, range.from, range.to,
                                 [&](double nu) { return of(ours, nu); }));
  };
  Panel scaled = density_panel("{P}* {ν}_{c}/({ν}{C}) [–]", range);
  scaled.y.include = 0;
  for (const TestRecord& test : input.tests) {
    if (!is_isotropic_unloading(test)) continue;
    Series series = dem_symbols(test, &Observation::nu, &Observation::P_star, kRowsShown,
                                plain("DEM seed " + std::to_string(test.packing.seed)), Colour::blue,
                                marker_of(index_of(seeds, test.packing.seed)));
    const Series C = dem_symbols(test, &Observation::nu, &Observation::C, kRowsShown, {}, Colour::blue, Marker::none);
    for (std::size_t i = 0; i < series.y.size(); ++i) series.y[i] *= ours.isotropic.pressure.nu_c / (C.x[i] * C.y[i]);
    scaled.series.push_back(series);
  }
  add_curves(scaled, has_values(input.calibration.law, "pressure"),
             [](const auto& p, double nu) { return p.isotropic.pressure.scaled(nu); });

  Panel overlap = density_panel("mean overlap ⟨δ⟩/⟨{r}⟩ [–]", range);
  overlap.y.include = 0;
  add_isotropic_symbols(overlap, input, &Observation::mean_overlap);
  add_curves(overlap, has_values(input.calibration.law, "overlap"), [](const auto& p, double nu) {
    return nu > p.isotropic.pressure.nu_c ? p.overlap_D * std::log(nu / p.isotropic.pressure.nu_c) : 0.0;
  });

  Panel trace = density_panel("fabric trace {F}_{v} [–]", range);
  trace.y.from = 2.5;
  add_isotropic_symbols(trace, input, &Observation::F_v);
  add_curves(trace, has_values(input.calibration.law, "fabric"),
             [](const auto& p, double nu) { return p.fabric_g3 * nu * p.isotropic.C(nu); });

  for (Panel* panel : {&overlap, &trace}) {
    for (Series& series : panel->series) {
      if (series.marker != Marker::none) series.label = {};  // named in the first panel
    }
  }
  figure.panels = {scaled, overlap, trace};
  return figure;
}

}  // namespace grainlaw::app::report
