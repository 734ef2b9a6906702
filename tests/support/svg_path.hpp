#pragma once
// Corners of SVG path data that is a moveto followed by pairs, relative, as app/report/svg_path.hpp writes it.

#include <array>
#include <cctype>
#include <cstdlib>
#include <string>
#include <vector>

namespace grainlaw::test {

using Corners = std::vector<std::array<double, 2>>;

/// Each piece of `data`, in absolute coordinates [px].
inline std::vector<Corners> corners_of(const std::string& data) {
  std::vector<Corners> pieces;
  std::array<double, 2> at{0, 0};
  for (const char* c = data.c_str(); *c != '\0';) {
    if (*c == 'm') {
      pieces.emplace_back();
      ++c;
    } else if (*c == 'z') {
      at = pieces.back().front();
      ++c;
    } else if (*c == ' ') {
      ++c;
    } else {
      for (double& coordinate : at) {
        char* end = nullptr;
        coordinate += std::strtod(c, &end);
        if (end == c) return {};  // no number: not such data
        c = end;
      }
      pieces.back().push_back(at);
    }
  }
  return pieces;
}

/// The data of the first path of `svg` whose attributes begin with class="`kind`.
inline std::string path_data(const std::string& svg, const std::string& kind) {
  const std::size_t path = svg.find("<path class=\"" + kind);
  if (path == std::string::npos) return "";
  const std::size_t begin = svg.find(" d=\"", path) + 4;
  return svg.substr(begin, svg.find('"', begin) - begin);
}

}  // namespace grainlaw::test
