#include "dem/element_tests/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/vocabulary/error.hpp"
#include "model/vocabulary/portable.hpp"

namespace grainlaw::dem {
namespace {

bool is_upright(const StraightSegment& segment) {
  const Eigen::Matrix3d& D = segment.direction.tensor;
  return (D - Eigen::Matrix3d(D.diagonal().asDiagonal())).norm() == 0 && segment.spin.isZero(0);
}

/// The functions of a cosine drive: those of the C library, or the same bits everywhere.
struct Elementary {
  double (*expm1)(double);
  double (*log1p)(double);
  double (*sin)(double);
  double (*cos)(double);
};
const Elementary& elementary(bool portable) {
  static constexpr Elementary kLibrary{[](double x) { return std::expm1(x); }, [](double x) { return std::log1p(x); },
                                       [](double x) { return std::sin(x); }, [](double x) { return std::cos(x); }};
  static constexpr Elementary kPortable{portable::expm1, portable::log1p, portable::sin, portable::cos};
  return portable ? kPortable : kLibrary;
}

}  // namespace

void check_can_follow(const std::vector<StraightSegment>& segments) {
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (is_upright(segments[k])) continue;
    throw InvalidInput(
        fmt::format("segments[{}]: the engine deforms the cell along its axes only; give a diagonal rate_tensor, or "
                    "ask the law alone (grainlaw predict without --dem)",
                    k));
  }
}

double strain_of(const StraightSegment& segment) {
  return segment.length * std::max(std::abs(segment.eps_vol_rate()), segment.eps_dev_rate());
}

Drive make_drive(const StraightSegment& segment, const DriveOptions& options, const Eigen::Matrix3d& H_0) {
  if (!is_upright(segment)) {
    throw InvalidInput("the engine deforms the cell along its axes only; give a diagonal rate_tensor");
  }
  if (!(options.strain_rate > 0) || !std::isfinite(options.strain_rate)) {
    throw InvalidInput("strain_rate: must be positive and finite");
  }
  Drive drive{segment, options, H_0, 0};
  const double peak_over_mean = options.profile == Profile::cosine ? std::numbers::pi / 2 : 1;
  drive.duration = peak_over_mean * strain_of(segment) / options.strain_rate;
  return drive;
}

Eigen::Vector3d stretch_of(const StraightSegment& segment, double e) {
  // One function for all three: Eigen's exp() takes vectors of two and another for the third, which differ in the last bit.
  double (*const exp)(double) = segment.portable ? portable::exp : [](double x) { return std::exp(x); };
  return (e * segment.direction.tensor.diagonal()).unaryExpr(exp);
}

double leading_rate(const Eigen::Matrix3d& D) {
  const double compressed = D.diagonal().minCoeff();
  return compressed < 0 ? compressed : D.diagonal().maxCoeff();
}

double path_parameter(const Drive& drive, double t) {
  const double length = drive.segment.length;
  if (t <= 0) return 0;
  if (t >= drive.duration) return length;
  if (drive.options.profile == Profile::constant) return length * t / drive.duration;
  const double a = leading_rate(drive.segment.direction.tensor);
  const Elementary& f = elementary(drive.segment.portable);
  const double stretch = f.expm1(a * length);  // (z_f - z_0)/z_0
  return f.log1p(stretch * (1 - f.cos(std::numbers::pi * t / drive.duration)) / 2) / a;
}

double path_parameter_rate(const Drive& drive, double t) {
  if (t < 0 || t > drive.duration) return 0;
  if (drive.options.profile == Profile::constant) return drive.segment.length / drive.duration;
  const double a = leading_rate(drive.segment.direction.tensor);
  const Elementary& f = elementary(drive.segment.portable);
  const double stretch = f.expm1(a * drive.segment.length);
  const double phase = std::numbers::pi * t / drive.duration;
  const double z = 1 + stretch * (1 - f.cos(phase)) / 2;
  return stretch * f.sin(phase) * std::numbers::pi / (2 * drive.duration) / (z * a);
}

CellMotion motion_at(const Drive& drive, double t) {
  const double e = path_parameter(drive, t);
  CellMotion motion;
  motion.H = stretch_of(drive.segment, e).asDiagonal() * drive.H_0;
  motion.L = path_parameter_rate(drive, t) * drive.segment.direction.tensor;
  motion.transport = drive.options.transport;
  return motion;
}

}  // namespace grainlaw::dem
