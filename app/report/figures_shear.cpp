#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "app/report/figures.hpp"
#include "app/report/series.hpp"
#include "model/reduced_law.hpp"

namespace grainlaw::app::report {
namespace {

/// What differs between the figures of the shear tests.
struct Shear {
  const char* id;
  const char* title;
  const char* symbol;
  const char* equation;  ///< that saturates it, of a run and of the published law; null: none does
  double (*measured)(const Observation&, const LawParameters<double>&);
  std::vector<double> chain::FittedCurve::*curve;
  double (*unit)(double nu, const LawParameters<double>&);  ///< of the curve
  Estimate fit::ShearFit::*limit = nullptr;
  Estimate fit::ShearFit::*rate = nullptr;
  double fit::ShearFit::*start = nullptr;
  double (*published)(const LawParameters<double>&, double nu, double eps_dev) = nullptr;
};

constexpr std::size_t kSymbolsOfShear = 24;
constexpr int kPointsOfFit = 40;

/// Mode, branch and density: what one panel shows.
struct PanelKey {
  Mode mode;
  Branch branch;
  double nu;

  bool matches(const TestRecord& test) const {
    return test.path.segments.front().mode == mode && test.path.branch == branch && is_same_density(test.path.nu, nu);
  }
};

std::vector<PanelKey> panel_keys(const std::vector<const TestRecord*>& tests) {
  std::vector<PanelKey> keys;
  for (const TestRecord* test : tests) {
    const bool known = std::any_of(keys.begin(), keys.end(), [&](const PanelKey& key) { return key.matches(*test); });
    if (!known) keys.push_back({test->path.segments.front().mode, test->path.branch, test->path.nu});
  }
  std::sort(keys.begin(), keys.end(), [](const PanelKey& a, const PanelKey& b) {
    return std::tuple(a.mode, a.branch == Branch::loading, a.nu) <
           std::tuple(b.mode, b.branch == Branch::loading, b.nu);
  });
  return keys;
}

std::string panel_title(const PanelKey& key, const std::vector<PanelKey>& keys) {
  const bool several_modes = std::ranges::any_of(keys, [&](const PanelKey& other) { return other.mode != key.mode; });
  return fmt::format("{}{}{{ν}} = {:.3f}", several_modes ? to_string(key.mode) + ", " : "",
                     key.branch == Branch::loading ? "loading branch, " : "", key.nu);
}

double largest_strain(const TestRecord& test) {
  double largest = 0;
  for (const Observation& row : test.rows) {
    if (row.eps_dev > largest) largest = row.eps_dev;
  }
  return largest;
}

/// A run, and Eq. (17) or (18) fitted to it where that was possible.
void add_run(Panel& panel, const TestRecord& test, const chain::ReportInput& input, const Shear& what) {
  const LawParameters<double>& parameters = input.calibration.law.parameters;
  panel.series.push_back(through(open_symbols(plain("DEM"), Colour::grey, Marker::circle, 2),
                                 symbol_rows(test, kSymbolsOfShear), &Observation::eps_dev,
                                 [&](const Observation& row) { return what.measured(row, parameters); }));
  if (what.equation == nullptr) return;
  for (const fit::ShearFit& fit : input.calibration.shear) {
    if (fit.test != test.name) continue;
    const Estimate &limit = fit.*what.limit, &rate = fit.*what.rate;
    if (limit.status == Status::not_identified || rate.status == Status::not_identified) return;
    Series line =
        line_of(plain(std::string("Eq. ") + what.equation + ", fitted run by run"), Colour::orange, Line::solid, 1);
    line.toggle = "run by run";
    line.initially_hidden = true;
    panel.series.push_back(curve(
        line, 0, largest_strain(test),
        [&](double e) { return saturating(limit.value, fit.*what.start, rate.value, e); }, kPointsOfFit));
    return;
  }
}

/// The law's rungs along the panel's path: the recommended one in full, others behind their toggles.
void add_rungs(Panel& panel, const PanelKey& key, const chain::ReportInput& input, const Shear& what) {
  for (const chain::FittedPath& fitted : input.fitted_paths) {
    const Path& path = fitted.path;
    if (path.segments.front().mode != key.mode || path.branch != key.branch || !is_same_density(path.nu, key.nu))
      continue;
    for (const chain::FittedCurve& drawn : fitted.curves) {
      const bool first = drawn.model == fitted.recommended;
      Series line = line_of(plain(to_string(drawn.model) + (first ? ", recommended" : "")), colour_of(drawn.model),
                            Line::solid, first ? 2.2 : 1.2);
      line.toggle = first ? "" : to_string(drawn.model);
      line.initially_hidden = !first;
      line.x = drawn.eps_dev;
      for (const double y : drawn.*what.curve)
        line.y.push_back(y / what.unit(key.nu, input.calibration.law.parameters));
      panel.series.push_back(std::move(line));
    }
    return;
  }
}

Figure figure_of_shear(const chain::ReportInput& input, const Shear& what) {
  std::vector<const TestRecord*> tests;
  for (const TestRecord& test : input.tests) {
    if (is_pure_shear(test)) tests.push_back(&test);
  }
  const auto keys = panel_keys(tests);
  std::vector<Panel> panels;
  for (const PanelKey& key : keys) {
    Panel& panel = panels.emplace_back(panel_of(panel_title(key, keys).c_str(), kStrainLabel, what.symbol));
    panel.x.include = 0;
    panel.y.include = what.equation == nullptr ? 1 : 0;
    double end = 0;
    for (const TestRecord* test : tests) {
      if (!key.matches(*test)) continue;
      add_run(panel, *test, input, what);
      end = std::max(end, largest_strain(*test));
    }
    add_rungs(panel, key, input, what);
    if (what.published == nullptr || key.mode != Mode::D2) continue;
    panel.series.push_back(curve(
        line_of(plain("published (D2)"), Colour::ink, Line::dashed), 0, end,
        [&](double e) { return what.published(published_parameters(), key.nu, e); }, kPointsOfFit));
  }
  std::string caption =
      "Grey: DEM runs. Thick line: the recommended rung from the law's own start, for D3 with the factors of its Lode "
      "angle; runs from the loading branch are outside the law, which knows that of unloading. Other rungs";
  caption += what.equation == nullptr
                 ? " behind the buttons."
                 : std::string(" and Eq. ") + what.equation +
                       " fitted to each run behind the buttons. Dashed: Table 3 of the paper, which is of D2.";
  if (input.fitted_paths.empty())
    caption =
        "Grey: DEM runs. The law is not drawn: fitted_paths.json is missing; make it with: " + input.calibrate_command;
  return {.id = what.id,
          .title = what.title,
          .description =
              "One panel for each mode and density, over deviatoric strain. Symbols are DEM runs, the thick line the "
              "recommended rung of the law, dashed lines the published law.",
          .caption = plain(caption),
          .sources = {"dataset/", "calibration.json", "fitted_paths.json"},
          .panels = panels,
          .columns = keys.size() <= 4   ? 2
                     : keys.size() <= 9 ? 3
                                        : 4,
          .panel_height = keys.size() <= 9 ? 190.0 : 120.0,
          .shared_axes = true};
}

double one(double, const LawParameters<double>&) { return 1; }

}  // namespace

Figure stress_ratio_figure(const chain::ReportInput& input) {
  return figure_of_shear(input,
                         {.id = "stress-ratio",
                          .title = "Stress ratio in shear at constant volume",
                          .symbol = "stress ratio {s}_{∥} [–]",
                          .equation = "17",
                          .measured = [](const Observation& row, const LawParameters<double>&) { return row.s_par; },
                          .curve = &chain::FittedCurve::s_par,
                          .unit = one,
                          .limit = &fit::ShearFit::s_max,
                          .rate = &fit::ShearFit::beta_s,
                          .start = &fit::ShearFit::s_0,
                          .published = [](const LawParameters<double>& p, double nu,
                                          double e) { return reduced_stress_ratio(p, nu, 0.0, e); }});
}

Figure fabric_figure(const chain::ReportInput& input) {
  return figure_of_shear(
      input,
      {.id = "fabric",
       .title = "Deviatoric fabric in shear at constant volume",
       .symbol = "fabric {F}_{∥} [–]",
       .equation = "18",
       .measured = [](const Observation& row, const LawParameters<double>&) { return row.F_par; },
       .curve = &chain::FittedCurve::F_par,
       .unit = one,
       .limit = &fit::ShearFit::F_max,
       .rate = &fit::ShearFit::beta_F,
       .start = &fit::ShearFit::F_0,
       .published = [](const LawParameters<double>& p, double nu, double e) { return reduced_fabric(p, nu, 0.0, e); }});
}

Figure sheared_pressure_figure(const chain::ReportInput& input) {
  return figure_of_shear(
      input, {.id = "sheared-pressure",
              .title = "Pressure in shear at constant volume, over that of isotropic unloading at the same density",
              .symbol = "{P}*/{P}*_{ISO}({ν}) [–]",
              .equation = nullptr,
              .measured = [](const Observation& row,
                             const LawParameters<double>& p) { return row.P_star / p.isotropic.P_star(row.nu); },
              .curve = &chain::FittedCurve::P_star,
              .unit = [](double nu, const LawParameters<double>& p) { return p.isotropic.P_star(nu); }});
}

}  // namespace grainlaw::app::report
