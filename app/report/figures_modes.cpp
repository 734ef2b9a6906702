#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/report/figures.hpp"
#include "app/report/series.hpp"

namespace grainlaw::app::report {
namespace {

Series thin_line(const std::string& label, Colour colour, Line line) {
  return line_of(notation(label), colour, line, 1);
}

Series published_line(const std::string& mode, Colour colour) {
  return line_of(plain(mode + ", published"), colour, Line::dashed);
}

/// Whether all of the test is uniaxial, loading and unloading.
bool is_uniaxial_cycle(const TestRecord& test) {
  const auto& segments = test.path.segments;
  return segments.size() > 1 && std::ranges::all_of(segments, [](const PathSegment& s) { return s.mode == Mode::UNI; });
}

/// Whether the row is of a segment that expands.
bool in_expansion(const TestRecord& test, const Observation& row) {
  return test.path.segments[static_cast<std::size_t>(row.segment)].direction.tensor.trace() > 0;
}

const fit::Calibration* description_of(const chain::ReportInput& input, const char* name) {
  for (const fit::Description& d : input.modes.descriptions) {
    if (d.name == name) return &d.calibration;
  }
  return nullptr;
}

/// nu_c of Eq. (14) that the mode's own fit found; a description is read as its stages.
std::optional<double> jamming_density(const fit::Calibration& mode) {
  for (const fit::Stage& stage : mode.stages) {
    for (const fit::NamedEstimate& named : stage.estimates) {
      if (named.name == "pressure.nu_c" && named.estimate.status != Status::not_identified) return named.estimate.value;
    }
  }
  return std::nullopt;
}

/// When the compression of the packing that `test` decompresses had ended; 0 for other tests.
double time_before(const TestRecord& test, const chain::ReportInput& input) {
  double before = 0;
  for (const TestRecord& loading : input.tests) {
    if (is_isotropic_unloading(test) && is_isotropic_loading(loading) && loading.packing.seed == test.packing.seed &&
        !loading.rows.empty())
      before = loading.rows.back().time;
  }
  return before;
}

/// Fig. 1: compression and decompression of a packing one after the other, and its uniaxial cycle.
Panel time_panel(const chain::ReportInput& input) {
  Panel panel = panel_of("Fig. 1", "time [ms]", kDensityLabel);
  for (const TestRecord& test : input.tests) {
    const bool isotropic = is_isotropic_unloading(test) || is_isotropic_loading(test);
    if (!isotropic && !is_uniaxial_cycle(test)) continue;
    const double before = time_before(test, input);
    panel.series.push_back(through(
        isotropic ? thin_line("ISO", Colour::blue, Line::solid) : thin_line("UNI", Colour::green, Line::solid),
        line_rows(test), [=](const Observation& row) { return 1e3 * (before + row.time); }, &Observation::nu));
  }
  return panel;
}

/// Figs. 4, 6, 7: `measured` over volume fraction on both branches of ISO and UNI; published: the curve of Table 2.
void add_branches(Panel& panel, const chain::ReportInput& input, double Observation::*measured,
                  const DensityCurve& law) {
  double from = 1, to = 0;
  for (const TestRecord& test : input.tests) {
    const bool cycle = is_uniaxial_cycle(test);
    if (!cycle && !is_isotropic_unloading(test) && !is_isotropic_loading(test)) continue;
    for (const Observation& row : test.rows) from = std::min(from, row.nu), to = std::max(to, row.nu);
    const std::string mode = cycle ? "UNI" : "ISO";
    const Colour colour = cycle ? Colour::green : Colour::blue;
    const auto add = [&](const Series& style, bool expands) {
      panel.series.push_back(through(style, line_rows(test), &Observation::nu, measured, [&](const Observation& row) {
        return in_expansion(test, row) == expands && row.P_star > 0;
      }));
    };
    if (cycle || is_isotropic_loading(test)) add(thin_line(mode + ", loading", colour, Line::dotted), false);
    if (cycle || is_isotropic_unloading(test)) add(thin_line(mode, colour, Line::solid), true);
  }
  if (!(from < to)) return;
  const auto add_published = [&](const char* mode, Colour colour) {
    const LawParameters<double> p = published_parameters(mode);
    panel.series.push_back(curve(published_line(mode, colour), std::max(from, p.isotropic.coordination.nu_c), to,
                                 [&](double nu) { return law.of(p, nu); }));
  };
  add_published("ISO", Colour::ink);
  if (description_of(input, "UNI") != nullptr) add_published("UNI", Colour::purple);
}

/// Fig. 10: scaled pressure over the volumetric strain from each mode's own nu_c, decompression alone; steady shear as symbols.
Panel scaled_panel(const chain::ReportInput& input) {
  Panel panel = panel_of("Fig. 10", "ln({ν}/{ν}_{c}) [–]", "{P}* {ν}_{c}/({ν}{C}) [–]");
  panel.x.from = panel.y.from = 0;
  const auto add_runs = [&](const char* mode, double nu_c, Colour colour, const auto& is_of_mode) {
    for (const TestRecord& test : input.tests) {
      if (!is_of_mode(test)) continue;
      panel.series.push_back(through(
          thin_line(mode, colour, Line::solid), line_rows(test),
          [=](const Observation& row) { return std::log(row.nu / nu_c); },
          [=](const Observation& row) { return row.P_star * nu_c / (row.nu * row.C); },
          [&](const Observation& row) { return in_expansion(test, row) && row.nu > nu_c; }));
    }
  };
  const auto add_published = [&](const std::string& mode, const Pressure<double>& pressure, Colour colour) {
    panel.series.push_back(curve(published_line(mode, colour), 0, 0.22,
                                 [&](double x) { return pressure.scaled(pressure.nu_c * std::exp(x)); }));
  };
  const auto& ours = input.calibration;
  if (has_values(ours.law, "pressure"))
    add_runs("ISO", ours.law.parameters.isotropic.pressure.nu_c, Colour::blue, is_isotropic_unloading);
  const fit::Calibration* uniaxial = description_of(input, "UNI");
  const auto uniaxial_nu_c = uniaxial != nullptr ? jamming_density(*uniaxial) : std::nullopt;
  if (uniaxial_nu_c) add_runs("UNI", *uniaxial_nu_c, Colour::green, is_uniaxial_cycle);
  if (has_values(ours.law, "steady_pressure")) {
    const double nu_c = ours.law.parameters.steady.pressure.nu_c;
    panel.series.push_back(through(
        symbols(plain("steady D2, DEM (mean per run)"), Colour::vermillion, Marker::square), ours.shear,
        [=](const fit::ShearFit& fit) { return std::log(fit.nu / nu_c); },
        [=](const fit::ShearFit& fit) {
          return fit.P_star * nu_c / (fit.nu * (1 - fit.rattler_fraction) * fit.C_star);
        },
        [](const fit::ShearFit& fit) { return fit.mode == Mode::D2; }));
  }
  add_published("ISO", published_parameters().isotropic.pressure, Colour::ink);
  if (uniaxial != nullptr) add_published("UNI", published_parameters("UNI").isotropic.pressure, Colour::purple);
  add_published("D2", published_parameters().steady.pressure, Colour::orange);
  return panel;
}

/// Figs. 5, 8: D2 from both branches, where a density has both.
Panel branches_of_shear(const chain::ReportInput& input, const char* title, const char* label,
                        double Observation::*measured) {
  Panel panel = panel_of(title, kStrainLabel, label);
  std::vector<const TestRecord*> sheared, from_loading;
  for (const TestRecord& test : input.tests) {
    if (!is_pure_shear(test) || test.path.segments.front().mode != Mode::D2) continue;
    sheared.push_back(&test);
    if (test.path.branch == Branch::loading) from_loading.push_back(&test);
  }
  const std::vector<double> densities = densities_of(from_loading);
  for (const TestRecord* test : sheared) {
    const double nu = test->path.nu;
    const auto at = std::find_if(densities.begin(), densities.end(), [&](double d) { return is_same_density(d, nu); });
    if (at == densities.end()) continue;
    const bool loading = test->path.branch == Branch::loading;
    panel.series.push_back(through(
        thin_line(fmt::format("D2, {{ν}} = {:.3g}{}", nu, loading ? ", loading branch" : ""),
                  colour_of(static_cast<std::size_t>(at - densities.begin())), loading ? Line::dotted : Line::solid),
        line_rows(*test), &Observation::eps_dev, measured));
  }
  return panel;
}

}  // namespace

Figure modes_figure(const chain::ReportInput& input) {
  Panel coordination = panel_of("Figs. 4, 6", kDensityLabel, "coordination number {C}* [–]");
  coordination.y.from = 5.5;
  add_branches(coordination, input, &Observation::C_star, density_curve("C_star"));

  Panel rattlers = panel_of("Fig. 7", kDensityLabel, "rattler fraction {φ}_{r} [–]");
  rattlers.y.from = 0;
  rattlers.y.to = 0.3;
  add_branches(rattlers, input, &Observation::rattler_fraction, density_curve("rattler_fraction"));

  std::vector<Panel> panels{time_panel(input), coordination, rattlers, scaled_panel(input)};
  for (const Panel& of_shear :
       {branches_of_shear(input, "Fig. 5", "coordination number {C}* [–]", &Observation::C_star),
        branches_of_shear(input, "Fig. 8", "pressure {P}* [–]", &Observation::P_star)}) {
    if (!of_shear.series.empty()) panels.push_back(of_shear);
  }
  return {.id = "modes",
          .title = "The runs mode by mode, as the paper draws them",
          .description =
              "Volume fraction over time, coordination number and rattlers over volume fraction, scaled pressure over "
              "volumetric strain, and where D2 starts from both branches, its coordination number and pressure over "
              "deviatoric strain. Thin lines are DEM runs, dashed lines the published equations.",
          .caption = notation(
              "Figures of the paper by their numbers. Thin lines: DEM, one for each run; dotted: loading, or D2 from "
              "the loading branch; dashed: Table 2 of the paper. Time of decompression goes on from the compression "
              "before it, without the rest between them. {ν}_{c} of Fig. 10 is each mode's own."),
          .sources = {"dataset/", "calibration.json"},
          .panels = panels,
          .columns = 3,
          .panel_height = 270};
}

}  // namespace grainlaw::app::report
