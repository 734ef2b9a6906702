#include "model/vocabulary/path.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "model/vocabulary/error.hpp"
#include "model/vocabulary/portable.hpp"

namespace grainlaw {
namespace {

[[noreturn]] void refuse(std::size_t index, const char* key, const std::string& why) {
  throw InvalidInput(fmt::format("segments[{}].{}: {}", index, key, why));
}

void check_direction(const PathSegment& segment, std::size_t index) {
  const Eigen::Matrix3d& D = segment.direction.tensor;
  if (!D.allFinite() || !segment.spin.allFinite())
    refuse(index, "extent", "the direction of the segment must be finite");
  if ((segment.spin + segment.spin.transpose()).norm() != 0) refuse(index, "spin", "is not antisymmetric");
  bool ramped = false;
  for (std::size_t i = 0; i < segment.conditions.size(); ++i) {
    const Condition& condition = segment.conditions[i];
    const std::string name = free_name(condition);
    if (!std::isfinite(condition.rate)) refuse(index, "free", fmt::format("{}: its rate is not finite", name));
    ramped = ramped || condition.rate != 0;
    for (std::size_t j = 0; j < i; ++j) {
      if (segment.conditions[j].free == condition.free) refuse(index, "free", fmt::format("{} is given twice", name));
    }
    if (condition.free == Condition::volume) {
      if (condition.quantity == Condition::Quantity::stress)
        refuse(index, "free", "volume: a stress is held by the rate of its own component; give P_star or stress_ratio");
      continue;
    }
    const auto [a, b] = kComponentIndex.at(static_cast<std::size_t>(condition.free));
    if (D(a, b) != 0)
      refuse(index, "free", fmt::format("{0} is free and has a rate too; set the rate of {0} to 0", name));
  }
  if (D.norm() == 0 && !ramped) {
    refuse(index, "extent", "the direction of the segment must not be zero");
  }
}

/// Path parameter at which |eps'| of `strain` + e D comes to `target`, by its square: |q|^2 + 2 q.d e + |d|^2 e^2.
double length_to_eps_dev(const PathSegment& segment, const Strain& strain, std::size_t index) {
  const Deviator<double> q = deviator<double>(strain.tensor), d = deviator<double>(segment.direction.tensor);
  const double a = d.squaredNorm(), b = q.dot(d), c = q.squaredNorm() - segment.extent * segment.extent;
  const double discriminant = b * b - a * c;
  const auto unreachable = [&] {
    refuse(
        index, "extent",
        fmt::format("target_eps_dev {} cannot be reached from eps_dev = {:.6g} in this direction; set \"reverse\" or "
                    "another target",
                    segment.extent, q.norm()));
  };
  if (a < 1e-24 * segment.direction.tensor.squaredNorm() || discriminant < 0) unreachable();
  const double first = (-b - std::sqrt(discriminant)) / a, second = (-b + std::sqrt(discriminant)) / a;
  const double length = first > 0 ? first : second;
  if (!(length > 0)) unreachable();
  return length;
}

double length_of(const PathSegment& segment, double nu, const Strain& strain, std::size_t index, bool portable) {
  const double shear = deviatoric_norm(segment.direction.tensor);
  const double volume = segment.direction.tensor.trace();
  const double scale = segment.direction.tensor.norm();
  switch (segment.extent_kind) {
    case ExtentKind::eps_dev:
      if (shear < 1e-12 * scale)
        refuse(index, "extent", "eps_dev cannot be reached by an isotropic strain rate; give eps_vol or target_nu");
      return segment.extent / shear;
    case ExtentKind::eps_vol:
      if (std::abs(volume) < 1e-12 * scale)
        refuse(index, "extent", "eps_vol cannot be reached at constant volume; give eps_dev");
      return segment.extent / std::abs(volume);
    case ExtentKind::target_eps_dev:
      return length_to_eps_dev(segment, strain, index);
    case ExtentKind::target_nu:
    case ExtentKind::target_P_star:
    case ExtentKind::target_stress_ratio:
      break;
  }
  if (std::abs(volume) < 1e-12 * scale)
    refuse(index, "extent", "target_nu cannot be reached at constant volume; give eps_dev");
  const double ratio = segment.extent / nu;
  const double length = -(portable ? portable::log(ratio) : std::log(ratio)) / volume;
  if (!(length > 0)) {
    refuse(index, "extent",
           fmt::format("target_nu {} lies behind nu = {:.6g} for this direction; set \"reverse\" or another target",
                       segment.extent, nu));
  }
  return length;
}

void check_nu(double nu, const std::string& where) {
  if (!(nu > 0 && nu <= kMaxVolumeFraction)) {
    throw InvalidInput(fmt::format("{}: volume fraction {:.6g} is outside (0, {}]", where, nu, kMaxVolumeFraction));
  }
}

void check_segment(const PathSegment& segment, std::size_t index) {
  if (!std::isfinite(segment.extent) || segment.extent <= 0) refuse(index, "extent", "give a positive, finite number");
  check_direction(segment, index);
}

/// The segments up to the first one whose end only the law knows.
std::vector<StraightSegment> resolve_known(const Path& path, bool portable = false) {
  std::vector<StraightSegment> segments;
  double nu = path.nu;
  Strain strain;
  check_nu(nu, "initial.nu");
  for (std::size_t i = 0; i < path.segments.size(); ++i) {
    if (law_decides(path.segments[i])) break;
    segments.push_back(resolve(path.segments[i], i, nu, strain, portable));
    nu = segments.back().nu(segments.back().length);
    strain = segments.back().strain(segments.back().length);
  }
  return segments;
}

}  // namespace

std::string free_name(const Condition& condition) {
  return condition.free == Condition::volume ? "volume" : kComponentName.at(static_cast<std::size_t>(condition.free));
}

StrainRate free_direction(const Condition& condition) {
  if (condition.free == Condition::volume) return {Eigen::Matrix3d::Identity() / 3};
  const auto [a, b] = kComponentIndex.at(static_cast<std::size_t>(condition.free));
  StrainRate rate;
  rate.tensor(a, b) = rate.tensor(b, a) = 1;
  return rate;
}

bool law_decides(const PathSegment& segment) {
  return !segment.conditions.empty() || segment.extent_kind == ExtentKind::target_P_star ||
         segment.extent_kind == ExtentKind::target_stress_ratio;
}

bool law_decides(const Path& path) {
  return std::ranges::any_of(path.segments, [](const PathSegment& segment) { return law_decides(segment); });
}

StrainRate direction_of(Mode mode, const std::string& axes, bool reverse) {
  Eigen::Vector3d role = Eigen::Vector3d::Zero();  // rates along the paper's x, y, z
  switch (mode) {
    case Mode::ISO:
      role << -1, -1, -1;
      break;
    case Mode::UNI:
      role << 0, 0, -1;
      break;
    case Mode::D2:
      role << 1, 0, -1;
      break;
    case Mode::D3:
      role << 0.5, 0.5, -1;
      break;
    case Mode::tensor:
      throw InvalidInput("mode 'tensor' has no direction of its own; give rate_tensor");
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

double StraightSegment::nu(double e) const {
  const double x = -eps_vol_rate() * e;
  return nu_start * (portable ? portable::exp(x) : std::exp(x));
}

Strain StraightSegment::strain(double e) const { return {strain_start.tensor + e * direction.tensor}; }

double StraightSegment::eps_dev_rate() const { return deviatoric_norm(direction.tensor); }

double StraightSegment::eps_vol_rate() const { return direction.tensor.trace(); }

StraightSegment resolve(const PathSegment& segment, std::size_t index, double nu, const Strain& strain, bool portable) {
  check_segment(segment, index);
  if (law_decides(segment)) {
    throw InvalidInput(fmt::format(
        "segments[{}]: its {} leaves the strain to the law, which only grainlaw predict without --dem asks; "
        "elsewhere give strains, e.g. those of a prediction as strain_csv",
        index, segment.conditions.empty() ? to_string(segment.extent_kind) : std::string("free")));
  }
  StraightSegment straight{segment.mode, segment.direction, length_of(segment, nu, strain, index, portable), nu, strain,
                           segment.spin, portable};
  check_nu(straight.nu(straight.length), fmt::format("segments[{}]", index));
  return straight;
}

namespace {

constexpr double kSameLeg = 0.01;  // difference of strains over the larger one, for paths that are one

/// What goes on in one direction, however it is written.
struct Leg {
  double nu = 0;
  Eigen::Matrix3d strain, turn;  // of the whole leg

  bool alike(const Leg& other) const {
    const double size = kSameLeg * std::max(strain.norm(), other.strain.norm());
    return (strain - other.strain).norm() <= size && (turn - other.turn).norm() <= size;
  }
};

std::vector<Leg> legs_of(const std::vector<StraightSegment>& path) {
  std::vector<Leg> legs;
  for (const StraightSegment& segment : path) {
    const Leg leg{segment.nu_start, segment.length * segment.direction.tensor, segment.length * segment.spin};
    Leg* before = legs.empty() ? nullptr : &legs.back();
    const double ratio = before == nullptr ? 0 : leg.strain.norm() / before->strain.norm();
    if (before != nullptr && leg.alike({leg.nu, ratio * before->strain, ratio * before->turn})) {
      before->strain += leg.strain;
      before->turn += leg.turn;
    } else {
      legs.push_back(leg);
    }
  }
  return legs;
}

bool same(const std::vector<Leg>& a, const std::vector<Leg>& b) {
  return std::ranges::equal(
      a, b, [](const Leg& p, const Leg& q) { return p.alike(q) && std::abs(p.nu - q.nu) <= kSameDensity; });
}

/// Axes that turn with the path. Legs have unlike weights, so that two axes are alike only where they are in all legs.
Eigen::Matrix3d own_axes(const std::vector<Leg>& legs) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double weight = 1;
  for (const Leg& leg : legs) {
    sum += weight * (leg.strain + leg.turn * leg.turn);
    weight = 0.5 + std::fmod(weight + 0.618, 1.0);
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors();
}

}  // namespace

bool same_path(const std::vector<StraightSegment>& a, const std::vector<StraightSegment>& b) {
  return same(legs_of(a), legs_of(b));
}

bool same_but_axes(const std::vector<StraightSegment>& a, const std::vector<StraightSegment>& b) {
  const std::vector<Leg> of_a = legs_of(a), of_b = legs_of(b);
  const Eigen::Matrix3d from = own_axes(of_b), to = own_axes(of_a);
  for (int mirrored = -1; mirrored < 3; ++mirrored) {  // a tensor does not see all three
    Eigen::Vector3d sign = Eigen::Vector3d::Ones();
    if (mirrored >= 0) sign(mirrored) = -1;
    const Eigen::Matrix3d Q = to * sign.asDiagonal() * from.transpose();
    std::vector<Leg> turned = of_b;
    for (Leg& leg : turned) {
      leg.strain = Q * leg.strain * Q.transpose();
      leg.turn = Q * leg.turn * Q.transpose();
    }
    if (same(of_a, turned)) return true;
  }
  return false;
}

bool same_path(const Path& a, const Path& b) {
  return a.branch == b.branch && !law_decides(a) && !law_decides(b) && same_path(resolve(a), resolve(b));
}

std::vector<StraightSegment> resolve(const Path& path, bool portable) {
  std::vector<StraightSegment> segments = resolve_known(path, portable);
  if (segments.size() < path.segments.size()) resolve(path.segments[segments.size()], segments.size(), path.nu, {});
  return segments;
}

void check(const Path& path) {
  const std::size_t known = resolve_known(path).size();
  for (std::size_t i = known; i < path.segments.size(); ++i) check_segment(path.segments[i], i);
}

bool shears(const StrainRate& direction) {
  return deviatoric_norm(direction.tensor) > kPathNoise * std::abs(direction.tensor.trace());
}

Deviator<double> shear_direction(const std::vector<StraightSegment>& segments) {
  for (const StraightSegment& segment : segments) {
    const Deviator<double> d = -deviator<double>(segment.direction.tensor);
    if (shears(segment.direction)) return d / d.norm();
  }
  return Deviator<double>::Zero();
}

}  // namespace grainlaw
