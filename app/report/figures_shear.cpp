#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "app/report/figures.hpp"
#include "app/report/series.hpp"
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
  double Observation::*measured;
  Estimate fit::ShearFit::*limit;
  Estimate fit::ShearFit::*rate;
  double fit::ShearFit::*start;
  double (*law)(const LawParameters<double>&, double nu, double eps_dev);
};

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
  const bool several_modes =
      std::any_of(keys.begin(), keys.end(), [&](const PanelKey& other) { return other.mode != key.mode; });
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
void add_run(Panel& panel, const TestRecord& test, const chain::ReportInput& input, const Saturation& what,
             std::size_t seed) {
  const std::string number = std::to_string(test.packing.seed);
  panel.series.push_back(through(open_symbols(plain("DEM seed " + number), colour_of(seed), marker_of(seed), 2),
                                 symbol_rows(test, 70), &Observation::eps_dev, what.measured));
  for (const fit::ShearFit& fit : input.calibration.shear) {
    if (fit.test != test.name) continue;
    const Estimate &limit = fit.*what.limit, &rate = fit.*what.rate;
    if (limit.status == Status::not_identified || rate.status == Status::not_identified) return;
    panel.series.push_back(curve(line_of(plain("fit of seed " + number), colour_of(seed), Line::solid), 0,
                                 largest_strain(test),
                                 [&](double e) { return saturating(limit.value, fit.*what.start, rate.value, e); }));
    return;
  }
}

Figure saturation_figure(const chain::ReportInput& input, const Saturation& what) {
  std::vector<const TestRecord*> tests;
  for (const TestRecord& test : input.tests) {
    if (is_pure_shear(test)) tests.push_back(&test);
  }
  const auto keys = panel_keys(tests);
  const auto seeds = seeds_of(input.tests);
  const bool known =
      has_values(input.calibration.law, what.groups[0]) && has_values(input.calibration.law, what.groups[1]);
  std::vector<Panel> panels;
  for (const PanelKey& key : keys) {
    Panel& panel = panels.emplace_back(panel_of(panel_title(key, keys).c_str(), kStrainLabel, what.symbol));
    panel.x.include = panel.y.include = 0;
    double end = 0;
    for (const TestRecord* test : tests) {
      if (!key.matches(*test)) continue;
      add_run(panel, *test, input, what, index_of(seeds, test->packing.seed));
      end = std::max(end, largest_strain(*test));
    }
    const auto add_law = [&](const char* name, Line line, const LawParameters<double>& p) {
      panel.series.push_back(
          curve(line_of(plain(name), Colour::ink, line), 0, end, [&](double e) { return what.law(p, key.nu, e); }));
    };
    if (known) add_law("law, final parameters", Line::dotted, input.calibration.law.parameters);
    add_law("published", Line::dashed, published_parameters());
  }
  return {
      .id = what.id,
      .title = what.title,
      .description = fmt::format(
          "One panel per density. Over deviatoric strain the quantity rises from about zero and saturates; the "
          "plateau is lower at higher density. Symbols are DEM runs, solid lines the fits of Eq. {}, dashed lines "
          "the published law.",
          what.equation),
      .caption = notation(fmt::format(
          "Signed along the direction of shear. Solid: Eq. {} fitted to each run; dotted: the same equation with the "
          "parameters after the coupled fit, started from zero; dashed: with Table 3 of the paper.",
          what.equation)),
      .sources = {"dataset/", "calibration.json", "parameters.json"},
      .panels = panels,
      .columns = keys.size() <= 4   ? 2
                 : keys.size() <= 9 ? 3
                                    : 4,
      .panel_height = 190,
      .shared_axes = true};
}

}  // namespace

Figure stress_ratio_figure(const chain::ReportInput& input) {
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

Figure fabric_figure(const chain::ReportInput& input) {
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
