#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/report/series.hpp"
#include "app/report/figures.hpp"

namespace grainlaw::app::report {
namespace {

struct Measure {
  const char* label;
  double floor;  ///< smaller values matter to nobody
  double (*of)(const Observation&);
};

constexpr std::array<Measure, 3> kMeasures{
    {{"{E}_{kin}/{E}_{pot} [–]", 1e-9, [](const Observation& row) { return row.E_kin / row.E_pot; }},
     {"|energy residual| [–]", 1e-9, [](const Observation& row) { return std::abs(row.energy_residual); }},
     {"inertial number {I} [–]", 1e-6, [](const Observation& row) { return row.inertial_number; }}}};

/// A thin line through the rows: these series are too dense for symbols.
template <class Abscissa>
Series dem_line(const TestRecord& test, const Abscissa& x, const Measure& measure, Text label, Colour colour,
                Line line) {
  Series series;
  series.label = std::move(label);
  series.colour = colour;
  series.line = line;
  series.line_width = 1;
  for (const Observation& row : test.rows) {
    series.x.push_back(x(row));
    series.y.push_back(measure.of(row));
  }
  return series;
}

/// Densities beyond the number of colours repeat them in another line.
Line line_of(std::size_t density) { return density < kColourCount - 1 ? Line::solid : Line::dotted; }

Figure quality_figure(const char* id, const char* title, const char* x_label, double x_from, double x_to) {
  Figure figure;
  figure.id = id;
  figure.title = title;
  figure.sources = {"dataset/"};
  figure.columns = 3;
  figure.panel_height = 220;
  for (const Measure& measure : kMeasures) {
    Panel panel;
    panel.x.label = notation(x_label);
    panel.y.label = notation(measure.label);
    panel.x.from = x_from;
    panel.x.to = x_to;
    panel.y.logarithmic = true;
    panel.y.floor = measure.floor;
    figure.panels.push_back(panel);
  }
  return figure;
}

}  // namespace

Figure preparation_quality_figure(const ReportInput& input) {
  double lowest = 1, highest = 0;
  for (const TestRecord& test : input.tests) {
    if (!is_isotropic_unloading(test) && !is_isotropic_loading(test)) continue;
    for (const Observation& row : test.rows) {
      lowest = std::min(lowest, row.nu);
      highest = std::max(highest, row.nu);
    }
  }
  if (!(lowest < highest)) lowest = 0, highest = 1;
  Figure figure = quality_figure("quality-isotropic",
                                 "Kinetic energy, energy balance and inertial number on the isotropic branches",
                                 "volume fraction {ν} [–]", lowest, highest);
  figure.description =
      "Three panels over volume fraction with logarithmic ordinates: ratio of kinetic to potential energy, magnitude "
      "of the energy residual, inertial number. The first and the last fall with density.";
  figure.caption = notation(
      "DEM as lines. The energy residual is the box work minus what was stored and dissipated, over |work| + initial "
      "kinetic energy + dissipation. A run warns beyond 10^{−3} and stops beyond 10^{−2}. Lines that leave a panel "
      "at its lower edge go on to smaller values.");
  for (std::size_t m = 0; m < kMeasures.size(); ++m) {
    for (const TestRecord& test : input.tests) {
      const bool unloading = is_isotropic_unloading(test);
      if (!unloading && !is_isotropic_loading(test)) continue;
      const auto seed = index_of(seeds_of(input.tests), test.packing.seed);
      const std::string label = fmt::format("{}, seed {}", unloading ? "unloading" : "loading", test.packing.seed);
      figure.panels[m].series.push_back(dem_line(
          test, [](const Observation& row) { return row.nu; }, kMeasures[m], plain(label), colour_of(seed),
          unloading ? Line::solid : Line::dotted));
    }
  }
  return figure;
}

Figure shear_quality_figure(const ReportInput& input) {
  Figure figure =
      quality_figure("quality-shear", "Kinetic energy, energy balance and inertial number in the element tests",
                     "part of the test's duration [–]", 0, 1);
  figure.description =
      "Three panels over the course of each test with logarithmic ordinates: ratio of kinetic to potential energy, "
      "magnitude of the energy residual, inertial number, one line per run, colours by density.";
  figure.caption =
      notation("All runs of the data set that shear, a line each, colours by the density {ν} at the start.");
  std::vector<const TestRecord*> sheared;
  for (const TestRecord& test : input.tests) {
    if (!is_isotropic_loading(test) && !is_isotropic_unloading(test)) sheared.push_back(&test);
  }
  const std::vector<double> densities = densities_of(sheared);
  for (std::size_t m = 0; m < kMeasures.size(); ++m) {
    for (std::size_t d = 0; d < densities.size(); ++d) {
      for (const TestRecord* test : sheared) {
        if (std::abs(test->path.nu - densities[d]) >= 1e-6) continue;
        const double duration = test->rows.empty() ? 1 : test->rows.back().time;
        figure.panels[m].series.push_back(dem_line(
            *test, [=](const Observation& row) { return row.time / duration; }, kMeasures[m],
            notation(fmt::format("{{ν}} = {:.3f}", densities[d])), colour_of(d), line_of(d)));
      }
    }
  }
  return figure;
}

}  // namespace grainlaw::app::report
