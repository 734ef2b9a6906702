#pragma once
// Pieces that figures are put together from: points of entries, rows of a run, a curve of the law, axes; and which marker and
// colour belong to which seed and density.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "app/report/figure.hpp"
#include "model/calibrated_law.hpp"
#include "model/density_curves.hpp"
#include "model/law.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::app::report {

/// Of volume fractions that a law is drawn over.
struct Range {
  double from, to;
};

/// Labels of axes that many figures share, in the notation of text.hpp.
inline constexpr const char* kDensityLabel = "volume fraction {ν} [–]";
inline constexpr const char* kStrainLabel = "deviatoric strain {ε}_{dev} [–]";

/// A panel without series; labels and title in the notation of text.hpp, the title may be empty.
Panel panel_of(const char* title, const char* x, const char* y);

/// How a series looks; its points are still to come. Symbols of DEM runs are small and open; dashed lines have the toggle "published".
Series symbols(Text label, Colour colour, Marker marker, double size = 3);
Series open_symbols(Text label, Colour colour, Marker marker, double size = 3);
Series line_of(Text label, Colour colour, Line line, double width = 1.8);

struct Always {
  bool operator()(const auto&) const { return true; }
};

/// `style` through x and y, members or functions, of each of `entries` that `keep` accepts.
template <class Entries, class X, class Y, class Keep = Always>
Series through(Series style, const Entries& entries, const X& x, const Y& y, const Keep& keep = {}) {
  for (const auto& entry : entries) {
    if (!std::invoke(keep, entry)) continue;
    style.x.push_back(std::invoke(x, entry));
    style.y.push_back(std::invoke(y, entry));
  }
  return style;
}

/// `style` along `function` at evenly spaced points of [from, to].
template <class Function>
Series curve(Series style, double from, double to, const Function& function, int points = 160) {
  for (int i = 0; i <= points; ++i) {
    const double x = from + (to - from) * i / points;
    style.x.push_back(x);
    style.y.push_back(function(x));
  }
  return style;
}

/// The law's curve over volume fraction that files call `quantity`.
const DensityCurve& density_curve(const std::string& quantity);

/// About `points` of `rows`, evenly spaced, and the last.
template <class Row>
std::vector<Row> thinned(const std::vector<Row>& rows, std::size_t points) {
  std::vector<Row> few;
  const std::size_t stride = std::max<std::size_t>(1, rows.size() / points);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i % stride == 0 || i + 1 == rows.size()) few.push_back(rows[i]);
  }
  return few;
}

/// Evenly spaced rows of a run: about `points` as symbols, more as a line, which ends with the last row.
std::vector<Observation> symbol_rows(const TestRecord& test, std::size_t points);
std::vector<Observation> line_rows(const TestRecord& test);

/// Seeds of the tests, ascending, each once, and their number in words: "2 seeds".
std::vector<std::uint64_t> seeds_of(const std::vector<TestRecord>& tests);
std::string seed_count(const std::vector<TestRecord>& tests);
/// Position of `seed` in `seeds`; their number when absent.
std::size_t index_of(const std::vector<std::uint64_t>& seeds, std::uint64_t seed);

/// Starting densities of the tests, ascending; those closer than 1e-6 are one.
std::vector<double> densities_of(const std::vector<const TestRecord*>& tests);
bool is_same_density(double a, double b);

/// Marker and colour of the i-th seed (or density), repeating after the last.
Marker marker_of(std::size_t i);
Colour colour_of(std::size_t i);

Colour colour_of(Rung rung);

/// Modes of the path, e.g. "D2", "D2→ISO→ISO".
std::string kind_of(const Path& path);

}  // namespace grainlaw::app::report
