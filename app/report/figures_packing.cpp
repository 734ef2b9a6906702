#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "app/report/figures.hpp"
#include "app/report/number_text.hpp"
#include "app/report/svg_path.hpp"
#include "app/report/svg_series.hpp"

namespace grainlaw::app::report {
namespace {

using dem::PackingPicture;

constexpr double kPanelWidth = 470, kMargin = 10, kHeading = 24;  // [px]
constexpr std::array<double, 6> kForceSteps{0.25, 0.75, 1.25,
                                            1.75, 2.5,  3.5};  ///< of chains drawn alike, over the mean

std::string panel_svg(const std::string& title, double height, const std::string& body) {
  return fmt::format(
      "<svg class=\"p\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\">\n"
      "<text class=\"title\" x=\"{3}\" y=\"15\" text-anchor=\"middle\">{2}</text>\n{4}</svg>\n",
      kPanelWidth, pixels(height), to_svg(plain(title)), kPanelWidth / 2, body);
}

/// Spheres in grey; chains as wide as their force, those above the mean in colour. `scale` [px per mean radius].
std::string slice_svg(const std::string& title, const PackingPicture& picture, double scale, const std::string& clip) {
  const double left = (kPanelWidth - scale * picture.width) / 2, bottom = kHeading + scale * picture.height;
  const std::string frame = fmt::format("x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", pixels(left), pixels(kHeading),
                                        pixels(scale * picture.width), pixels(scale * picture.height));
  std::string svg = fmt::format(
      "<clipPath id=\"{}\"><rect {}/></clipPath>\n<g clip-path=\"url(#{})\">\n<g class=\"k7 f\" "
      "fill-opacity=\".25\">\n",
      clip, frame, clip);
  for (const auto& [x, y, r] : picture.circles)
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n", left + scale * x, bottom - scale * y,
                       scale * r);
  svg += "</g>\n";
  std::array<SvgPath, kForceSteps.size()> paths;
  for (const auto& [x1, y1, x2, y2, force] : picture.chains) {
    const auto above = std::upper_bound(kForceSteps.begin(), kForceSteps.end(), force);
    if (above == kForceSteps.begin()) continue;
    SvgPath& path = paths[static_cast<std::size_t>(above - kForceSteps.begin()) - 1];
    path.move(left + scale * x1, bottom - scale * y1);
    path.line(left + scale * x2, bottom - scale * y2);
  }
  for (std::size_t i = 0; i < paths.size(); ++i)
    svg += fmt::format("<path class=\"{} l\" stroke-width=\"{:.1f}\" stroke-linecap=\"round\" d=\"{}\"/>\n",
                       kForceSteps[i] < 1 ? "k1" : "k2", 1.1 * (kForceSteps[i] + 0.25), paths[i].data());
  return panel_svg(title, bottom + kMargin, svg + fmt::format("</g>\n<rect class=\"axis\" {}/>\n", frame));
}

/// Both halves of a rose whose bins are over 180 degrees.
std::string rose_path(const std::vector<double>& rose, double scale, double x, double y) {
  SvgPath path;
  const std::size_t bins = rose.size();
  for (std::size_t i = 0; i < 2 * bins; ++i) {
    const double r = scale * rose[i % bins];
    for (const std::size_t end : {i, i + 1}) {
      const double angle = std::numbers::pi * static_cast<double>(end) / static_cast<double>(bins);
      const double px = x + r * std::cos(angle), py = y - r * std::sin(angle);
      i == 0 && end == 0 ? path.move(px, py) : path.line(px, py);
    }
  }
  path.close();
  return path.data();
}

std::string rose_svg(const std::string& title, const std::vector<double>& before, const std::vector<double>& after,
                     const dem::ShearPictures& pictures) {
  constexpr double radius = 100, x = kPanelWidth / 2, y = kHeading + 22 + radius;
  const double largest = std::max(*std::ranges::max_element(before), *std::ranges::max_element(after));
  const double scale = radius / largest;
  const auto label = [&](double at_x, double at_y, const std::string& words) {
    return fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", at_x, at_y, to_svg(plain(words)));
  };
  return panel_svg(
      title, y + radius + 24,
      fmt::format("<path class=\"axis\" d=\"M{} {}h{}M{} {}v{}\"/>\n<circle class=\"axis\" cx=\"{}\" cy=\"{}\" "
                  "r=\"{:.1f}\"/>\n<path class=\"k2 b\" d=\"{}\"/>\n<path class=\"k2 l\" stroke-width=\"1.8\" "
                  "d=\"{}\"/>\n<path class=\"k0 l d2\" stroke-width=\"1.5\" d=\"{}\"/>\n",
                  x - radius, y, 2 * radius, x, y - radius, 2 * radius, x, y, scale, rose_path(after, scale, x, y),
                  rose_path(after, scale, x, y), rose_path(before, scale, x, y)) +
          label(x, y - radius - 6, pictures.vertical + ", compressed") +
          label(x + radius + 62, y + 4, pictures.horizontal + ", extended") +
          label(x, y + radius + 18, "dotted: before; filled: after; circle: isotropic"));
}

/// Mean of the bins within 20 degrees of the vertical axis over that of those within 20 degrees of the horizontal one.
double along_over_across(const std::vector<double>& rose) {
  const std::size_t half = rose.size() / 2;
  return (rose[half - 2] + rose[half - 1] + rose[half] + rose[half + 1]) /
         (rose[0] + rose[1] + rose[rose.size() - 2] + rose[rose.size() - 1]);
}

}  // namespace

Drawing packing_drawing(const dem::ShearPictures& pictures) {
  const PackingPicture &before = pictures.before, &after = pictures.after;
  const double scale = (kPanelWidth - 2 * kMargin) / std::max(before.width, after.width);
  const std::string strain = significant(pictures.strain, 3);
  std::string caption = fmt::format(
      "{}: {} spheres at ν = {}, sheared at constant volume to a deviatoric strain of {}. Grey: what a plane cuts of "
      "the spheres; lines: contacts within half a mean radius of it, as wide as the force, red above the mean force of "
      "all contacts.",
      pictures.test, pictures.particles, significant(pictures.nu, 3), strain);
  Drawing drawing{"packing", "A packing and its force chains before and after shear", {}, {}, {"dataset/pictures.json"},
                  {}};
  drawing.description =
      "Spheres cut by a plane, lines between the centres of those that touch, as wide as the force; and how many "
      "contacts, and how much force, there is in each direction of the plane.";
  drawing.panels = {slice_svg("before shear", before, scale, "packing-before"),
                    slice_svg("after shear to " + strain, after, scale, "packing-after")};
  if (!before.count.empty() && !after.count.empty()) {
    drawing.panels.push_back(rose_svg("contacts", before.count, after.count, pictures));
    drawing.panels.push_back(rose_svg("forces", before.force, after.force, pictures));
    caption += fmt::format(
        " Below: contacts and forces in each direction of this plane, over the mean of all directions. Along the "
        "compressed axis there are {} times as many contacts as along the extended one after shear ({} before), which "
        "carry {} times the force ({}).",
        fixed(along_over_across(after.count), 2), fixed(along_over_across(before.count), 2),
        fixed(along_over_across(after.force), 2), fixed(along_over_across(before.force), 2));
  }
  drawing.caption = plain(pictures.note.empty() ? caption : caption + " " + pictures.note);
  return drawing;
}

}  // namespace grainlaw::app::report
