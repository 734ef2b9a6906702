#include "app/report/series.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace grainlaw::app::report {

Series dem_symbols(const TestRecord& test, Quantity x, Quantity y, int points, Text label, Colour colour,
                   Marker marker) {
  Series series;
  series.label = std::move(label);
  series.colour = colour;
  series.marker = marker;
  series.open_marker = true;
  series.marker_size = 2;
  const std::size_t rows = test.rows.size();
  const std::size_t wanted = static_cast<std::size_t>(std::max(1, points));
  const std::size_t stride = std::max<std::size_t>(1, (rows + wanted - 1) / wanted);
  for (std::size_t i = 0; i < rows; i += stride) {
    series.x.push_back(test.rows[i].*x);
    series.y.push_back(test.rows[i].*y);
  }
  return series;
}

std::vector<std::uint64_t> seeds_of(const std::vector<TestRecord>& tests) {
  std::vector<std::uint64_t> seeds;
  for (const TestRecord& test : tests) seeds.push_back(test.packing.seed);
  std::sort(seeds.begin(), seeds.end());
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  return seeds;
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

std::size_t index_of(const std::vector<std::uint64_t>& sorted, std::uint64_t value) {
  return static_cast<std::size_t>(std::find(sorted.begin(), sorted.end(), value) - sorted.begin());
}

std::vector<double> densities_of(const std::vector<const TestRecord*>& tests) {
  std::vector<double> densities;
  for (const TestRecord* test : tests) densities.push_back(test->path.nu);
  std::sort(densities.begin(), densities.end());
  const auto same = [](double a, double b) { return std::abs(a - b) < 1e-6; };
  densities.erase(std::unique(densities.begin(), densities.end(), same), densities.end());
  return densities;
}

std::string seed_count(const std::vector<TestRecord>& tests) {
  const std::size_t count = seeds_of(tests).size();
  return std::to_string(count) + (count == 1 ? " seed" : " seeds");
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
