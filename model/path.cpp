#include "model/path.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "model/error.hpp"

namespace grainlaw {
namespace {

constexpr double kMaxVolumeFraction = 0.9;  // beyond it overlaps are no small fraction of the radius any more

double length_of(const PathSegment& segment, double nu, std::size_t index) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(fmt::format("segments[{}].extent: {}", index, why));
  };
  const double shear = deviatoric_norm(segment.direction.tensor);
  const double volume = segment.direction.tensor.trace();
  const double scale = segment.direction.tensor.norm();
  if (!std::isfinite(scale) || scale == 0) refuse("the direction of the segment must be finite and not zero");
  if (!std::isfinite(segment.extent) || segment.extent <= 0) refuse("give a positive, finite number");
  switch (segment.extent_kind) {
    case ExtentKind::eps_dev:
      if (shear < 1e-12 * scale) refuse("eps_dev cannot be reached by an isotropic strain rate; give eps_vol or target_nu");
      return segment.extent / shear;
    case ExtentKind::eps_vol:
      if (std::abs(volume) < 1e-12 * scale) refuse("eps_vol cannot be reached at constant volume; give eps_dev");
      return segment.extent / std::abs(volume);
    case ExtentKind::target_nu: break;
  }
  if (std::abs(volume) < 1e-12 * scale) refuse("target_nu cannot be reached at constant volume; give eps_dev");
  const double length = -std::log(segment.extent / nu) / volume;
  if (!(length > 0)) {
    refuse(fmt::format("target_nu {} lies behind nu = {:.6g} for this direction; set \"reverse\" or another target",
                       segment.extent, nu));
  }
  return length;
}

}  // namespace

std::string to_string(Mode mode) {
  switch (mode) {
    case Mode::ISO: return "ISO";
    case Mode::UNI: return "UNI";
    case Mode::D2: return "D2";
    case Mode::D3: return "D3";
    case Mode::tensor: break;
  }
  return "tensor";
}

std::string to_string(Branch branch) { return branch == Branch::loading ? "loading" : "unloading"; }

StrainRate direction_of(Mode mode, const std::string& axes, bool reverse) {
  Eigen::Vector3d role = Eigen::Vector3d::Zero();  // rates along the paper's x, y, z
  switch (mode) {
    case Mode::ISO: role << -1, -1, -1; break;
    case Mode::UNI: role << 0, 0, -1; break;
    case Mode::D2: role << 1, 0, -1; break;
    case Mode::D3: role << 0.5, 0.5, -1; break;
    case Mode::tensor: throw InvalidInput("mode 'tensor' has no direction of its own; give rate_tensor");
  }
  std::string sorted = axes;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != "xyz") throw InvalidInput(fmt::format("axes: '{}' is not a permutation of xyz", axes));
  StrainRate rate;
  for (int i = 0; i < 3; ++i) {
    const int axis = axes[static_cast<std::size_t>(i)] - 'x';
    rate.tensor(axis, axis) = reverse ? -role(i) : role(i);
  }
  return rate;
}

double StraightSegment::nu(double e) const { return nu_start * std::exp(-eps_vol_rate() * e); }

Strain StraightSegment::strain(double e) const { return {strain_start.tensor + e * direction.tensor}; }

double StraightSegment::eps_dev_rate() const { return deviatoric_norm(direction.tensor); }

double StraightSegment::eps_vol_rate() const { return direction.tensor.trace(); }

std::vector<StraightSegment> resolve(const Path& path) {
  std::vector<StraightSegment> segments;
  double nu = path.nu;
  Strain strain;
  const auto check_nu = [&](const std::string& where) {
    if (!(nu > 0 && nu <= kMaxVolumeFraction)) {
      throw InvalidInput(fmt::format("{}: volume fraction {:.6g} is outside (0, {}]", where, nu, kMaxVolumeFraction));
    }
  };
  check_nu("initial.nu");
  for (std::size_t i = 0; i < path.segments.size(); ++i) {
    const PathSegment& given = path.segments[i];
    StraightSegment segment{given.mode, given.direction, length_of(given, nu, i), nu, strain};
    nu = segment.nu(segment.length);
    strain = segment.strain(segment.length);
    check_nu(fmt::format("segments[{}]", i));
    segments.push_back(segment);
  }
  return segments;
}

Deviator<double> shear_direction(const std::vector<StraightSegment>& segments) {
  for (const StraightSegment& segment : segments) {
    const Deviator<double> d = -deviator<double>(segment.direction.tensor);
    if (d.norm() > 1e-12 * segment.direction.tensor.norm()) return d / d.norm();
  }
  return Deviator<double>::Zero();
}

}  // namespace grainlaw
