#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "app/report/dem_series.hpp"
#include "app/report/figures.hpp"
#include "app/report/law_curves.hpp"
#include "model/reduced_law.hpp"

namespace grainlaw::app::report {
namespace {

/// What differs between the figures of Eq. (17) and Eq. (18).
struct Saturation {
  const char* id;
  const char* title;
  const char* symbol;
  const char* equation;
  std::array<const char*, 2> groups;  ///< of parameters that `law` reads
  Quantity measured;
  Estimate fit::ShearFit::*limit;
  Estimate fit::ShearFit::*rate;
  double fit::ShearFit::*start;
  double (*law)(const LawParameters<double>&, double nu, double eps_dev);
};

std::vector<const TestRecord*> shear_tests(const ReportInput& input) {
  std::vector<const TestRecord*> tests;
  for (const TestRecord& test : input.tests) {
    if (is_pure_shear(test)) tests.push_back(&test);
  }
  return tests;
}

/// Mode, branch and density: what one panel shows.
struct PanelKey {
  Mode mode;
  Branch branch;
  double nu;

  bool matches(const TestRecord& test) const {
    return test.path.segments.front().mode == mode && test.path.branch == branch && std::abs(test.path.nu - nu) < 1e-6;
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

Text panel_title(const PanelKey& key, const std::vector<PanelKey>& keys) {
  const bool several_modes =
      std::any_of(keys.begin(), keys.end(), [&](const PanelKey& other) { return other.mode != key.mode; });
  std::string prefix = several_modes ? to_string(key.mode) + ", " : "";
  if (key.branch == Branch::loading) prefix += "loading branch, ";
  return plain(prefix) + notation(fmt::format("{{ν}} = {:.3f}", key.nu));
}

double largest_strain(const TestRecord& test) {
  double largest = 0;
  for (const Observation& row : test.rows) {
    if (row.eps_dev > largest) largest = row.eps_dev;
  }
  return largest;
}

void add_run(Panel& panel, const TestRecord& test, const ReportInput& input, const Saturation& what, std::size_t seed) {
  const std::string number = std::to_string(test.packing.seed);
  panel.series.push_back(dem_symbols(test, &Observation::eps_dev, what.measured, 70, plain("DEM seed " + number),
                                     colour_of(seed), marker_of(seed)));
  const auto& fits = input.calibration.shear;
  const auto found =
      std::find_if(fits.begin(), fits.end(), [&](const fit::ShearFit& f) { return f.test == test.name; });
  if (found == fits.end()) return;
  if (((*found).*what.limit).status == Status::not_identified ||
      ((*found).*what.rate).status == Status::not_identified) {
    return;
  }
  const double limit = ((*found).*what.limit).value, rate = ((*found).*what.rate).value, start = (*found).*what.start;
  panel.series.push_back(curve(plain("fit of seed " + number), colour_of(seed), Line::solid, 0, largest_strain(test),
                               [=](double e) { return saturating(limit, start, rate, e); }));
}

Figure saturation_figure(const ReportInput& input, const Saturation& what) {
  Figure figure;
  figure.id = what.id;
  figure.title = what.title;
  figure.description = fmt::format(
      "One panel per density. Over deviatoric strain the quantity rises from about zero and saturates; the plateau "
      "is lower at higher density. Symbols are DEM runs, solid lines the fits of Eq. {}, dashed lines the published "
      "law.",
      what.equation);
  figure.caption = notation(fmt::format(
      "Signed along the direction of shear. Solid: Eq. {} fitted to each run; dotted: the same equation with the "
      "parameters after the coupled fit, started from zero; dashed: with Table 3 of the paper.",
      what.equation));
  figure.sources = {"dataset/", "calibration.json", "parameters.json"};
  figure.shared_axes = true;
  figure.panel_height = 190;

  const auto tests = shear_tests(input);
  const auto keys = panel_keys(tests);
  const auto seeds = seeds_of(input.tests);
  const LawParameters<double> published = published_parameters();
  figure.columns = keys.size() <= 4 ? 2 : keys.size() <= 9 ? 3 : 4;
  for (const PanelKey& key : keys) {
    Panel panel;
    panel.title = panel_title(key, keys);
    panel.x.label = notation("deviatoric strain {ε}_{dev} [–]");
    panel.x.include = 0;
    panel.y.label = notation(what.symbol);
    panel.y.include = 0;
    double end = 0;
    for (const TestRecord* test : tests) {
      if (!key.matches(*test)) continue;
      add_run(panel, *test, input, what, index_of(seeds, test->packing.seed));
      end = std::max(end, largest_strain(*test));
    }
    if (has_values(input.calibration.law, what.groups[0]) && has_values(input.calibration.law, what.groups[1])) {
      panel.series.push_back(curve(plain("law, final parameters"), Colour::ink, Line::dotted, 0, end,
                                   [&](double e) { return what.law(input.calibration.law.parameters, key.nu, e); }));
    }
    panel.series.push_back(curve(plain("published"), Colour::ink, Line::dashed, 0, end,
                                 [&](double e) { return what.law(published, key.nu, e); }));
    figure.panels.push_back(panel);
  }
  return figure;
}

}  // namespace

Figure stress_ratio_figure(const ReportInput& input) {
  return saturation_figure(
      input, {"stress-ratio",
              "Stress ratio in shear at constant volume",
              "stress ratio {s}_{∥} [–]",
              "17",
              {"stress_ratio_max", "stress_rate"},
              &Observation::s_par,
              &fit::ShearFit::s_max,
              &fit::ShearFit::beta_s,
              &fit::ShearFit::s_0,
              [](const LawParameters<double>& p, double nu, double e) { return reduced_stress_ratio(p, nu, 0.0, e); }});
}

Figure fabric_figure(const ReportInput& input) {
  return saturation_figure(
      input, {"fabric",
              "Deviatoric fabric in shear at constant volume",
              "fabric {F}_{∥} [–]",
              "18",
              {"fabric_max", "fabric_rate"},
              &Observation::F_par,
              &fit::ShearFit::F_max,
              &fit::ShearFit::beta_F,
              &fit::ShearFit::F_0,
              [](const LawParameters<double>& p, double nu, double e) { return reduced_fabric(p, nu, 0.0, e); }});
}

}  // namespace grainlaw::app::report
