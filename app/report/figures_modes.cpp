#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/report/dem_series.hpp"
#include "app/report/figures.hpp"
#include "app/report/law_curves.hpp"

namespace grainlaw::app::report {
namespace {

constexpr std::size_t kPointsOfALine = 60;  // of a run

/// Every so many rows, and the last.
template <class Keep, class X, class Y>
Series thin_line(const TestRecord& test, const Keep& keep, const X& x, const Y& y, const Text& label, Colour colour,
                 Line line) {
  Series series;
  series.label = label;
  series.colour = colour;
  series.line = line;
  series.line_width = 1;
  const std::size_t stride = std::max<std::size_t>(1, test.rows.size() / kPointsOfALine);
  for (std::size_t i = 0; i < test.rows.size(); ++i) {
    if ((i % stride != 0 && i + 1 != test.rows.size()) || !keep(test.rows[i])) continue;
    series.x.push_back(x(test.rows[i]));
    series.y.push_back(y(test.rows[i]));
  }
  return series;
}

bool every(const Observation&) { return true; }

/// Whether all of the test is uniaxial, loading and unloading.
bool is_uniaxial_cycle(const TestRecord& test) {
  const auto& segments = test.path.segments;
  return segments.size() > 1 &&
         std::all_of(segments.begin(), segments.end(), [](const PathSegment& s) { return s.mode == Mode::UNI; });
}

/// Whether the row is of a segment that expands (or not).
auto in_expansion(const TestRecord& test, bool expands) {
  return [&test, expands](const Observation& row) {
    return (test.path.segments[static_cast<std::size_t>(row.segment)].direction.tensor.trace() > 0) == expands;
  };
}

const fit::Calibration* description_of(const ReportInput& input, const char* name) {
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

Panel panel_of(const char* title, const char* x, const char* y) {
  Panel panel;
  panel.title = notation(title);
  panel.x.label = notation(x);
  panel.y.label = notation(y);
  return panel;
}

/// Fig. 1: compression and decompression of a packing one after the other, and its uniaxial cycle.
Panel time_panel(const ReportInput& input) {
  Panel panel = panel_of("Fig. 1", "time [ms]", "volume fraction {ν} [–]");
  const auto nu = [](const Observation& row) { return row.nu; };
  for (const TestRecord& test : input.tests) {
    double before = 0;
    if (is_isotropic_unloading(test)) {
      for (const TestRecord& loading : input.tests) {
        if (is_isotropic_loading(loading) && loading.packing.seed == test.packing.seed && !loading.rows.empty())
          before = loading.rows.back().time;
      }
    }
    const bool isotropic = is_isotropic_unloading(test) || is_isotropic_loading(test);
    if (!isotropic && !is_uniaxial_cycle(test)) continue;
    panel.series.push_back(thin_line(
        test, every, [=](const Observation& row) { return 1e3 * (before + row.time); }, nu,
        plain(isotropic ? "ISO" : "UNI"), isotropic ? Colour::blue : Colour::green, Line::solid));
  }
  return panel;
}

/// Figs. 4, 6, 7: `y` over volume fraction on both branches of ISO and UNI; published: `law` of Table 2.
template <class Y, class Law>
void add_branches(Panel& panel, const ReportInput& input, const Y& y, const Law& law) {
  const auto nu = [](const Observation& row) { return row.nu; };
  const auto add = [&](const TestRecord& test, const char* mode, Colour colour, bool expands) {
    panel.series.push_back(thin_line(
        test, [&](const Observation& row) { return in_expansion(test, expands)(row) && row.P_star > 0; }, nu, y,
        plain(std::string(mode) + (expands ? "" : ", loading")), colour, expands ? Line::solid : Line::dotted));
  };
  double from = 1, to = 0;
  for (const TestRecord& test : input.tests) {
    const bool cycle = is_uniaxial_cycle(test);
    if (!cycle && !is_isotropic_unloading(test) && !is_isotropic_loading(test)) continue;
    for (const Observation& row : test.rows) from = std::min(from, row.nu), to = std::max(to, row.nu);
    for (const bool expands : {false, true}) {
      if (cycle || expands == is_isotropic_unloading(test))
        add(test, cycle ? "UNI" : "ISO", cycle ? Colour::green : Colour::blue, expands);
    }
  }
  if (!(from < to)) return;
  const auto add_published = [&](const char* mode, Colour colour) {
    const LawParameters<double> p = published_parameters(mode);
    const double jammed = p.isotropic.coordination.nu_c;
    panel.series.push_back(curve(plain(std::string(mode) + ", published"), colour, Line::dashed, std::max(from, jammed),
                                 to, [&](double at) { return law(p, at); }));
  };
  add_published("ISO", Colour::ink);
  if (description_of(input, "UNI") != nullptr) add_published("UNI", Colour::purple);
}

/// Fig. 10: scaled pressure over the volumetric strain from each mode's own nu_c, decompression alone; steady shear as symbols.
Panel scaled_panel(const ReportInput& input) {
  Panel panel = panel_of("Fig. 10", "ln({ν}/{ν}_{c}) [–]", "{P}* {ν}_{c}/({ν}{C}) [–]");
  panel.x.from = panel.y.from = 0;
  const auto add_runs = [&](const char* mode, double nu_c, Colour colour, const auto& is_of_mode) {
    for (const TestRecord& test : input.tests) {
      if (!is_of_mode(test)) continue;
      panel.series.push_back(thin_line(
          test, [&](const Observation& row) { return in_expansion(test, true)(row) && row.nu > nu_c; },
          [=](const Observation& row) { return std::log(row.nu / nu_c); },
          [=](const Observation& row) { return row.P_star * nu_c / (row.nu * row.C); }, plain(mode), colour,
          Line::solid));
    }
  };
  const auto add_published = [&](const std::string& mode, const Pressure<double>& pressure, Colour colour) {
    panel.series.push_back(curve(plain(mode + ", published"), colour, Line::dashed, 0, 0.22,
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
    Series steady;
    steady.label = plain("steady D2, DEM (mean per run)");
    steady.colour = Colour::vermillion;
    steady.marker = Marker::square;
    for (const fit::ShearFit& shear : ours.shear) {
      if (shear.mode != Mode::D2) continue;
      steady.x.push_back(std::log(shear.nu / nu_c));
      steady.y.push_back(shear.P_star * nu_c / (shear.nu * (1 - shear.rattler_fraction) * shear.C_star));
    }
    panel.series.push_back(steady);
  }
  add_published("ISO", published_parameters().isotropic.pressure, Colour::ink);
  if (uniaxial != nullptr) add_published("UNI", published_parameters("UNI").isotropic.pressure, Colour::purple);
  add_published("D2", published_parameters().steady.pressure, Colour::orange);
  return panel;
}

/// Figs. 5, 8: D2 from both branches, where a density has both.
template <class Y>
Panel branches_of_shear(const ReportInput& input, const char* title, const char* label, const Y& y) {
  Panel panel = panel_of(title, "deviatoric strain {ε}_{dev} [–]", label);
  std::vector<const TestRecord*> from_loading;
  const auto is_D2 = [](const TestRecord& test) {
    return is_pure_shear(test) && test.path.segments.front().mode == Mode::D2;
  };
  for (const TestRecord& test : input.tests) {
    if (is_D2(test) && test.path.branch == Branch::loading) from_loading.push_back(&test);
  }
  const std::vector<double> densities = densities_of(from_loading);
  for (const TestRecord& test : input.tests) {
    if (!is_D2(test)) continue;
    const auto same = [&](double nu) { return std::abs(nu - test.path.nu) < 1e-6; };
    const auto at = std::find_if(densities.begin(), densities.end(), same);
    if (at == densities.end()) continue;
    const bool loading = test.path.branch == Branch::loading;
    panel.series.push_back(thin_line(
        test, every, [](const Observation& row) { return row.eps_dev; }, y,
        notation(fmt::format("D2, {{ν}} = {:.3g}{}", test.path.nu, loading ? ", loading branch" : "")),
        colour_of(static_cast<std::size_t>(at - densities.begin())), loading ? Line::dotted : Line::solid));
  }
  return panel;
}

}  // namespace

Figure modes_figure(const ReportInput& input) {
  const auto C_star = [](const Observation& row) { return row.C_star; };
  Figure figure;
  figure.id = "modes";
  figure.title = "The runs mode by mode, as the paper draws them";
  figure.description =
      "Volume fraction over time, coordination number and rattlers over volume fraction, scaled pressure over "
      "volumetric strain, and where D2 starts from both branches, its coordination number and pressure over deviatoric "
      "strain. "
      "Thin lines are DEM runs, dashed lines the published equations.";
  figure.caption = notation(
      "Figures of the paper by their numbers. Thin lines: DEM, one for each run; dotted: loading, or D2 from the "
      "loading branch; dashed: Table 2 of the paper. Time of decompression goes on from the compression before it, "
      "without the "
      "rest between them. {ν}_{c} of Fig. 10 is each mode's own.");
  figure.sources = {"dataset/", "calibration.json"};
  figure.columns = 3;
  figure.panel_height = 270;
  figure.panels.push_back(time_panel(input));

  Panel coordination = panel_of("Figs. 4, 6", "volume fraction {ν} [–]", "coordination number {C}* [–]");
  coordination.y.from = 5.5;
  add_branches(coordination, input, C_star,
               [](const LawParameters<double>& p, double nu) { return p.isotropic.coordination.C_star(nu); });
  figure.panels.push_back(coordination);

  Panel rattlers = panel_of("Fig. 7", "volume fraction {ν} [–]", "rattler fraction {φ}_{r} [–]");
  rattlers.y.from = 0;
  rattlers.y.to = 0.3;
  add_branches(
      rattlers, input, [](const Observation& row) { return row.rattler_fraction; },
      [](const LawParameters<double>& p, double nu) {
        return p.isotropic.rattlers.fraction(nu, p.isotropic.coordination.nu_c);
      });
  figure.panels.push_back(rattlers);

  figure.panels.push_back(scaled_panel(input));
  Panel shear_C = branches_of_shear(input, "Fig. 5", "coordination number {C}* [–]", C_star);
  if (!shear_C.series.empty()) {
    figure.panels.push_back(shear_C);
    figure.panels.push_back(
        branches_of_shear(input, "Fig. 8", "pressure {P}* [–]", [](const Observation& row) { return row.P_star; }));
  }
  return figure;
}

}  // namespace grainlaw::app::report
