#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/report/figures.hpp"
#include "app/report/series.hpp"

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

bool is_isotropic(const TestRecord& test) { return is_isotropic_unloading(test) || is_isotropic_loading(test); }

/// Densities beyond the number of colours repeat them in another line.
Line dash_of(std::size_t density) { return density < kColourCount - 1 ? Line::solid : Line::dotted; }

/// A panel for each measure; `add(panel, measure)` draws the runs, as thin lines: they are too dense for symbols.
template <class Add>
std::vector<Panel> quality_panels(const char* x_label, double x_from, double x_to, const Add& add) {
  std::vector<Panel> panels;
  for (const Measure& measure : kMeasures) {
    Panel& panel = panels.emplace_back(panel_of("", x_label, measure.label));
    panel.x.from = x_from;
    panel.x.to = x_to;
    panel.y.logarithmic = true;
    panel.y.floor = measure.floor;
    add(panel, measure);
  }
  return panels;
}

}  // namespace

Figure preparation_quality_figure(const chain::ReportInput& input) {
  double lowest = 1, highest = 0;
  for (const TestRecord& test : input.tests) {
    if (!is_isotropic(test)) continue;
    for (const Observation& row : test.rows) {
      lowest = std::min(lowest, row.nu);
      highest = std::max(highest, row.nu);
    }
  }
  if (!(lowest < highest)) lowest = 0, highest = 1;
  const auto seeds = seeds_of(input.tests);
  const auto add_runs = [&](Panel& panel, const Measure& measure) {
    for (const TestRecord& test : input.tests) {
      if (!is_isotropic(test)) continue;
      const bool unloading = is_isotropic_unloading(test);
      const std::string label = fmt::format("{}, seed {}", unloading ? "unloading" : "loading", test.packing.seed);
      panel.series.push_back(through(line_of(plain(label), colour_of(index_of(seeds, test.packing.seed)),
                                             unloading ? Line::solid : Line::dotted, 1),
                                     test.rows, &Observation::nu, measure.of));
    }
  };
  return {.id = "quality-isotropic",
          .title = "Kinetic energy, energy balance and inertial number on the isotropic branches",
          .description =
              "Three panels over volume fraction with logarithmic ordinates: ratio of kinetic to potential energy, "
              "magnitude of the energy residual, inertial number. The first and the last fall with density.",
          .caption = notation(
              "DEM as lines. The energy residual is the box work minus what was stored and dissipated, over |work| + "
              "initial kinetic energy + dissipation. A run warns beyond 10^{−3} and stops beyond 10^{−2}. Lines that "
              "leave a panel at its lower edge go on to smaller values."),
          .sources = {"dataset/"},
          .panels = quality_panels(kDensityLabel, lowest, highest, add_runs),
          .columns = 3,
          .panel_height = 220};
}

Figure shear_quality_figure(const chain::ReportInput& input) {
  std::vector<const TestRecord*> sheared;
  for (const TestRecord& test : input.tests) {
    if (!is_isotropic(test)) sheared.push_back(&test);
  }
  const std::vector<double> densities = densities_of(sheared);
  const auto add_runs = [&](Panel& panel, const Measure& measure) {
    for (std::size_t d = 0; d < densities.size(); ++d) {
      for (const TestRecord* test : sheared) {
        if (!is_same_density(test->path.nu, densities[d])) continue;
        const double duration = test->rows.empty() ? 1 : test->rows.back().time;
        panel.series.push_back(through(
            line_of(notation(fmt::format("{{ν}} = {:.3f}", densities[d])), colour_of(d), dash_of(d), 1), test->rows,
            [=](const Observation& row) { return row.time / duration; }, measure.of));
      }
    }
  };
  return {
      .id = "quality-shear",
      .title = "Kinetic energy, energy balance and inertial number in the element tests",
      .description =
          "Three panels over the course of each test with logarithmic ordinates: ratio of kinetic to potential "
          "energy, magnitude of the energy residual, inertial number, one line per run, colours by density.",
      .caption = notation("All runs of the data set that shear, a line each, colours by the density {ν} at the start."),
      .sources = {"dataset/"},
      .panels = quality_panels("part of the test's duration [–]", 0, 1, add_runs),
      .columns = 3,
      .panel_height = 220};
}

}  // namespace grainlaw::app::report
