#include <algorithm>
#include <cmath>

#include "app/report/figures.hpp"
#include "app/report/series.hpp"

namespace grainlaw::app::report {
namespace {

constexpr std::size_t kRowsShown = 60;

/// Rows of each run of isotropic unloading, called `name` and the seed; without a name they stay out of the legend.
template <class Y>
void add_isotropic_symbols(Panel& panel, const chain::ReportInput& input, const char* name, const Y& y) {
  const auto seeds = seeds_of(input.tests);
  for (const TestRecord& test : input.tests) {
    if (!is_isotropic_unloading(test)) continue;
    const std::uint64_t seed = test.packing.seed;
    const Text label = name == nullptr ? Text{} : plain(name + std::to_string(seed));
    Series style = open_symbols(label, Colour::blue, marker_of(index_of(seeds, seed)), 2);
    style.toggle = "seed " + std::to_string(seed);
    panel.series.push_back(through(style, symbol_rows(test, kRowsShown), &Observation::nu, y));
  }
}

void add_steady_symbols(Panel& panel, const chain::ReportInput& input, double fit::ShearFit::*y) {
  const auto add = [&](const fit::Calibration& calibration, Mode mode, Colour colour, Marker marker) {
    panel.series.push_back(
        through(symbols(plain("steady " + to_string(mode) + ", DEM (mean per run)"), colour, marker, 3.2),
                calibration.shear, &fit::ShearFit::nu, y, [=](const fit::ShearFit& fit) { return fit.mode == mode; }));
  };
  add(input.calibration, Mode::D2, Colour::vermillion, Marker::square);
  for (const fit::Description& d : input.modes.descriptions) {
    if (d.name == "D3") add(d.calibration, Mode::D3, Colour::green, Marker::diamond);
  }
}

/// From a little below jamming, where the laws begin, to the densest row.
Range shown_range(const chain::ReportInput& input) {
  const CalibratedLaw& c = input.calibration.law;
  double from = c.parameters.isotropic.pressure.nu_c;
  if (has_values(c, "steady_pressure")) from = std::min(from, c.parameters.steady.pressure.nu_c);
  return {std::min(from, c.range.nu_max - 0.01), c.range.nu_max};
}

/// `of` over the range, at the parameters `p`.
template <class Function>
void add_law(Panel& panel, const Range& range, const char* name, Colour colour, Line line,
             const LawParameters<double>& p, const Function& of) {
  panel.series.push_back(
      curve(line_of(plain(name), colour, line), range.from, range.to, [&](double nu) { return of(p, nu); }));
}

Panel density_panel(const char* label, const Range& range) {
  Panel panel = panel_of("", kDensityLabel, label);
  panel.x.from = range.from - 0.005;
  panel.x.to = range.to + 0.005;
  return panel;
}

/// One quantity of the state: runs, means of steady shear, and its law on isotropic unloading and in steady D2.
Panel state_panel(const chain::ReportInput& input, const char* label, const std::string& quantity,
                  double Observation::*measured, double fit::ShearFit::*steady_mean) {
  const Range range = shown_range(input);
  Panel panel = density_panel(label, range);
  add_isotropic_symbols(panel, input, "ISO unloading, DEM seed ", measured);
  add_steady_symbols(panel, input, steady_mean);
  const DensityCurve &isotropic = density_curve(quantity), &steady = density_curve("steady_" + quantity);
  const LawParameters<double>&ours = input.calibration.law.parameters, published = published_parameters();
  add_law(panel, range, "ISO, published", Colour::ink, Line::dashed, published, isotropic.of);
  add_law(panel, range, "steady D2, published", Colour::purple, Line::dashed, published, steady.of);
  if (has_values(input.calibration.law, isotropic))
    add_law(panel, range, "ISO, fitted", Colour::blue, Line::solid, ours, isotropic.of);
  if (has_values(input.calibration.law, steady))
    add_law(panel, range, "steady D2, fitted", Colour::vermillion, Line::solid, ours, steady.of);
  return panel;
}

/// A quantity of isotropic unloading alone, its law where `group` is identified; symbols are named in the first panel.
template <class Measured, class Law>
Panel unloading_panel(const chain::ReportInput& input, const char* label, const char* symbols_name,
                      const Measured& measured, const char* group, const Law& law) {
  const Range range = shown_range(input);
  Panel panel = density_panel(label, range);
  add_isotropic_symbols(panel, input, symbols_name, measured);
  add_law(panel, range, "published", Colour::ink, Line::dashed, published_parameters(), law);
  if (has_values(input.calibration.law, group))
    add_law(panel, range, "fitted", Colour::blue, Line::solid, input.calibration.law.parameters, law);
  return panel;
}

}  // namespace

Figure density_figure(const chain::ReportInput& input) {
  Panel pressure = state_panel(input, "pressure {P}* [–]", "P_star", &Observation::P_star, &fit::ShearFit::P_star);
  pressure.y.include = 0;
  Panel coordination =
      state_panel(input, "coordination number {C}* [–]", "C_star", &Observation::C_star, &fit::ShearFit::C_star);
  coordination.y.from = 5.5;  // below jamming the few particles with four contacts say nothing
  Panel rattlers = state_panel(input, "rattler fraction {φ}_{r} [–]", "rattler_fraction",
                               &Observation::rattler_fraction, &fit::ShearFit::rattler_fraction);
  rattlers.y.from = 0;
  rattlers.y.to = 0.3;
  return {
      .id = "density",
      .title = "Pressure, coordination and rattlers against volume fraction",
      .description =
          "Three panels over volume fraction: dimensionless pressure and corrected coordination number rise, the "
          "fraction of rattlers falls. Symbols are DEM data, solid lines the fitted equations 14, 11 and 12, dashed "
          "lines the published ones.",
      .caption = notation("{P}* with Eq. 14, {C}* with Eq. 11, {φ}_{r} with Eq. 12. Every run shows about 60 of its "
                          "rows. Dashed: Table 2 of the paper."),
      .sources = {"dataset/", "calibration.json", "parameters.json"},
      .panels = {pressure, coordination, rattlers},
      .columns = 3,
      .panel_height = 270};
}

Figure scaled_density_figure(const chain::ReportInput& input) {
  using P = LawParameters<double>;
  const double nu_c = input.calibration.law.parameters.isotropic.pressure.nu_c;
  Panel scaled = unloading_panel(
      input, "{P}* {ν}_{c}/({ν}{C}) [–]", "DEM seed ",
      [=](const Observation& row) { return row.P_star * (nu_c / (row.nu * row.C)); }, "pressure",
      [](const P& p, double nu) { return p.isotropic.pressure.scaled(nu); });
  scaled.y.include = 0;
  Panel overlap = unloading_panel(input, "mean overlap ⟨δ⟩/⟨{r}⟩ [–]", nullptr, &Observation::mean_overlap, "overlap",
                                  [](const P& p, double nu) {
                                    const double jammed = p.isotropic.pressure.nu_c;
                                    return nu > jammed ? p.overlap_D * std::log(nu / jammed) : 0.0;
                                  });
  overlap.y.include = 0;
  Panel trace = unloading_panel(input, "fabric trace {F}_{v} [–]", nullptr, &Observation::F_v, "fabric",
                                [](const P& p, double nu) { return p.fabric_g3 * nu * p.isotropic.C(nu); });
  trace.y.from = 2.5;
  return {.id = "scaled",
          .title = "Scaled pressure, overlap and fabric trace on isotropic unloading",
          .description =
              "Three panels over volume fraction, all rising: pressure divided by density and coordination, mean "
              "overlap of contacts, trace of the fabric tensor. Symbols are DEM data, solid lines the fitted "
              "equations, dashed lines the published ones.",
          .caption = notation("Scaled pressure {P}* {ν}_{c}/({ν}{C}) with Eq. 15, mean overlap with Eq. 13 ({D} "
                              "ln({ν}/{ν}_{c})), {F}_{v} with {g}_{3}{ν}{C}."),
          .sources = {"dataset/", "parameters.json"},
          .panels = {scaled, overlap, trace},
          .columns = 3,
          .panel_height = 230};
}

}  // namespace grainlaw::app::report
