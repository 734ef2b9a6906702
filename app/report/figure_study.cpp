#include "app/report/figure_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/report/series.hpp"

namespace grainlaw::app::report {
namespace {

constexpr std::array kMarkers{Marker::circle, Marker::square, Marker::triangle, Marker::diamond, Marker::plus};
constexpr std::array kColours{Colour::blue, Colour::green, Colour::purple, Colour::orange, Colour::sky};

/// `number`: of the setting. Neighbours differ in symbol and colour; the sixth to tenth are outlines, and each five have their
/// symbols in the colours of their neighbours before.
Series point_of(const chain::SettingResult& r, std::size_t number) {
  const bool good = r.dominated_by.empty() && !chain::near_the_stop(r.outcome.energy_residual);
  Series series = symbols(plain(r.outcome.name),
                          good ? kColours[(number + number / kMarkers.size()) % kColours.size()] : Colour::grey,
                          kMarkers[number % kMarkers.size()], 4);
  series.open_marker = number / kMarkers.size() % 2 == 1;
  series.x = {r.outcome.cost.particle_steps};
  series.y = {r.reached};
  series.y_error = {r.reached_error};
  return series;
}

/// The edge of what sampling makes, and the shade below it down to `bottom`.
std::array<Series, 2> floor_of(const std::vector<const chain::SettingResult*>& by_cost, chain::Packings packings,
                               double bottom) {
  Series edge, shade;
  edge.label = plain(packings == chain::Packings::given ? "floor: chance of the packings that all settings share"
                                                        : "floor: sampling, by the setting's own packings");
  edge.line = Line::dotted;
  shade.bands.emplace_back();
  for (const chain::SettingResult* r : by_cost) {
    const double noise = r->noise;
    if (!(noise > 0)) continue;
    edge.x.push_back(r->outcome.cost.particle_steps);
    edge.y.push_back(noise);
    shade.x.push_back(r->outcome.cost.particle_steps);
    shade.y.push_back((noise + bottom) / 2);
    shade.bands.front().push_back((noise - bottom) / 2);
  }
  return {shade, edge};
}

/// The decade strictly below the least error or floor.
double bottom_of(const std::vector<const chain::SettingResult*>& results) {
  double least = 1;
  for (const chain::SettingResult* r : results) {
    for (const double value : {r->reached, r->noise}) {
      if (value > 0) least = std::min(least, value);
    }
  }
  return std::pow(10.0, std::ceil(std::log10(least)) - 1);
}

Series work_series(const predict::WorkPrecision& study, predict::Integrator integrator, bool time) {
  constexpr Marker markers[] = {Marker::circle,  Marker::square, Marker::triangle,
                                Marker::diamond, Marker::cross,  Marker::plus};
  const int i = static_cast<int>(integrator);
  Series series;
  series.label = plain(to_string(integrator));
  series.colour = static_cast<Colour>(i % kColourCount);
  series.marker = markers[static_cast<std::size_t>(i) % std::size(markers)];
  series.open_marker = i >= kColourCount;
  series.line = i < 2 ? Line::solid : integrator == predict::Integrator::euler ? Line::dotted : Line::dashed;
  series.line_width = 1.2;
  for (const predict::WorkPoint& point : study.points) {
    if (point.integrator != integrator) continue;
    series.x.push_back(point.error);
    series.y.push_back(time ? point.microseconds : static_cast<double>(point.rhs_evaluations));
  }
  return series;
}

}  // namespace

Figure figure_of(const chain::SettingsStudy& study) {
  std::vector<const chain::SettingResult*> by_cost;
  for (std::size_t i = study.judged; i < study.results.size(); ++i) by_cost.push_back(&study.results[i]);
  std::stable_sort(by_cost.begin(), by_cost.end(), [](const auto* a, const auto* b) {
    return a->outcome.cost.particle_steps < b->outcome.cost.particle_steps;
  });
  Panel panel =
      panel_of("", "particle-steps",
               study.packings == chain::Packings::given ? "error reached, in units of the packings' chance [–]"
                                                        : "relative error reached [–]");
  panel.x.logarithmic = panel.y.logarithmic = true;
  const double bottom = bottom_of(by_cost);
  panel.y.from = bottom;
  for (const Series& series : floor_of(by_cost, study.packings, bottom)) panel.series.push_back(series);
  for (std::size_t i = study.judged + 1; i < study.results.size(); ++i) {
    if (std::isfinite(study.results[i].reached))
      panel.series.push_back(point_of(study.results[i], i - study.judged - 1));
  }
  Series star = point_of(study.results[study.judged], 0);
  star.marker = Marker::star;
  star.open_marker = false;
  star.marker_size = 7;
  if (star.colour != Colour::grey) star.colour = Colour::vermillion;
  panel.series.push_back(star);
  return {.id = "settings",
          .title = "Error of settings against their cost",
          .description = "Error reached over particle-steps. " + study.error +
                         ". Bars: one standard error by the packings. Shaded: what sampling alone makes; star: the "
                         "default; grey: dominated by a setting that costs no more and is better beyond chance, or so "
                         "near the energy balance's stop that other data sets would not be finished",
          .panels = {panel},
          .panel_height = 380};
}

Figure figure_of(const predict::IntegratorStudy& study) {
  Figure figure;
  figure.id = "work-precision";
  figure.title = "Work against precision of the integrators";
  figure.description = "Right-hand sides and time of one path over the error reached, for each integrator";
  figure.columns = static_cast<int>(study.panels.size());
  figure.panel_height = 260;
  for (const bool time : {false, true}) {
    for (const predict::WorkPrecision& work : study.panels) {
      Panel panel;
      panel.title = plain(work.path.name);
      panel.x.label = plain("error [–]");
      panel.y.label = plain(time ? "time of a path [µs]" : "right-hand sides");
      panel.x.logarithmic = panel.y.logarithmic = true;
      panel.x.floor = 1e-13;
      for (const predict::Integrator integrator : predict::kIntegrators)
        panel.series.push_back(work_series(work, integrator, time));
      figure.panels.push_back(panel);
    }
  }
  return figure;
}

}  // namespace grainlaw::app::report
