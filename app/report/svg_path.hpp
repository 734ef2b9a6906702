#pragma once
// Path data of an SVG <path>, relative and in tenths of a pixel: what a screen shows, in a third of the characters.

#include <array>
#include <string>
#include <vector>

namespace grainlaw::app::report {

using PixelPoints = std::vector<std::array<double, 2>>;

class SvgPath {
 public:
  void move(double x, double y);  ///< begins a piece
  void line(double x, double y);
  void close();
  /// A piece from point to point; nothing when there are none.
  void polyline(const PixelPoints& points);

  const std::string& data() const { return data_; }

 private:
  void to(double x, double y);

  std::string data_;
  long x_ = 0, y_ = 0;              ///< where the pen is [0.1 px]
  long start_x_ = 0, start_y_ = 0;  ///< of the piece
};

/// Those of `points` between which straight lines pass no other farther away than `tolerance` [px] (Douglas and Peucker);
/// the first and the last stay.
PixelPoints simplified(const PixelPoints& points, double tolerance);

}  // namespace grainlaw::app::report
