#include "app/report/series.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace grainlaw::app::report {

Panel panel_of(const char* title, const char* x, const char* y) {
  Panel panel;
  panel.title = notation(title);
  panel.x.label = notation(x);
  panel.y.label = notation(y);
  return panel;
}

Series symbols(Text label, Colour colour, Marker marker, double size) {
  Series series;
  series.label = std::move(label);
  series.colour = colour;
  series.marker = marker;
  series.marker_size = size;
  return series;
}

Series open_symbols(Text label, Colour colour, Marker marker, double size) {
  Series series = symbols(std::move(label), colour, marker, size);
  series.open_marker = true;
  return series;
}

Series line_of(Text label, Colour colour, Line line, double width) {
  Series series;
  series.label = std::move(label);
  series.colour = colour;
  series.line = line;
  series.line_width = width;
  if (line == Line::dashed) series.toggle = "published";
  return series;
}

const DensityCurve& density_curve(const std::string& quantity) {
  const auto& curves = density_curves();
  return *std::find_if(curves.begin(), curves.end(), [&](const auto& curve) { return curve.quantity == quantity; });
}

std::vector<Observation> symbol_rows(const TestRecord& test, std::size_t points) {
  std::vector<Observation> rows;
  const std::size_t stride = std::max<std::size_t>(1, (test.rows.size() + points - 1) / points);
  for (std::size_t i = 0; i < test.rows.size(); i += stride) rows.push_back(test.rows[i]);
  return rows;
}

std::vector<Observation> line_rows(const TestRecord& test) { return thinned(test.rows, 60); }

std::vector<std::uint64_t> seeds_of(const std::vector<TestRecord>& tests) {
  std::vector<std::uint64_t> seeds;
  for (const TestRecord& test : tests) seeds.push_back(test.packing.seed);
  std::sort(seeds.begin(), seeds.end());
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  return seeds;
}

std::string seed_count(const std::vector<TestRecord>& tests) {
  const std::size_t count = seeds_of(tests).size();
  return std::to_string(count) + (count == 1 ? " seed" : " seeds");
}

std::size_t index_of(const std::vector<std::uint64_t>& seeds, std::uint64_t seed) {
  return static_cast<std::size_t>(std::find(seeds.begin(), seeds.end(), seed) - seeds.begin());
}

bool is_same_density(double a, double b) { return std::abs(a - b) < 1e-6; }

std::vector<double> densities_of(const std::vector<const TestRecord*>& tests) {
  std::vector<double> densities;
  for (const TestRecord* test : tests) densities.push_back(test->path.nu);
  std::sort(densities.begin(), densities.end());
  densities.erase(std::unique(densities.begin(), densities.end(), is_same_density), densities.end());
  return densities;
}

Marker marker_of(std::size_t i) {
  static constexpr std::array markers{Marker::circle, Marker::triangle, Marker::diamond,
                                      Marker::square, Marker::cross,    Marker::plus};
  return markers[i % markers.size()];
}

Colour colour_of(std::size_t i) {
  // Ink stays free for what is published.
  static constexpr std::array colours{Colour::blue,   Colour::vermillion, Colour::green,
                                      Colour::purple, Colour::orange,     Colour::sky};
  return colours[i % colours.size()];
}

Colour colour_of(Rung rung) {
  return rung == Rung::reduced ? Colour::green : rung == Rung::evolution ? Colour::vermillion : Colour::blue;
}

std::string kind_of(const Path& path) {
  std::string kind;
  for (const PathSegment& segment : path.segments) {
    if (!kind.empty()) kind += "→";
    kind += to_string(segment.mode);
  }
  return kind;
}

}  // namespace grainlaw::app::report
