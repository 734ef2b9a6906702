#pragma once
// Strain paths that nobody would choose, for what has to hold on all of them.

#include <Eigen/Geometry>
#include <cstdint>
#include <random>
#include <vector>

#include "model/vocabulary/path.hpp"

namespace grainlaw::testing {

/// What a random path may do.
struct RandomPathKind {
  bool full = false;  ///< shear in all components, else along the axes
  bool spin = false;
};

/// 1 to 6 segments of a random direction, each .005 to .1 of strain long, with or without a change of volume, within
/// nu = .665 to .82. The same for the same seed.
inline std::vector<StraightSegment> random_path(std::uint64_t seed, const RandomPathKind& kind) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  const auto symmetric = [&] {
    Eigen::Matrix3d D = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      D(i, i) = uniform(-1, 1);
      for (int j = 0; kind.full && j < i; ++j) D(i, j) = D(j, i) = uniform(-1, 1);
    }
    return Eigen::Matrix3d(D - Eigen::Matrix3d::Identity() * (D.trace() / 3));
  };
  std::vector<StraightSegment> path;
  double nu = uniform(0.665, 0.82);
  Strain strain{Eigen::Matrix3d::Zero()};
  const auto count = 1 + static_cast<int>(uniform(0, 6));
  for (int k = 0; k < count; ++k) {
    StraightSegment segment;
    segment.mode = Mode::tensor;
    Eigen::Matrix3d D = symmetric();
    const double volume = uniform(0, 3) < 1 ? 0 : uniform(-1, 1);  // a third at constant volume
    D += Eigen::Matrix3d::Identity() * volume;
    segment.direction.tensor = D / D.norm();
    segment.length = uniform(0.005, 0.1);
    if (kind.spin) {
      const Eigen::Vector3d w(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      segment.spin << 0, -w(2), w(1), w(2), 0, -w(0), -w(1), w(0), 0;
      if (!kind.full) segment.spin(0, 2) = segment.spin(2, 0) = segment.spin(1, 2) = segment.spin(2, 1) = 0;
    }
    segment.nu_start = nu;
    segment.strain_start = strain;
    const double end = segment.nu(segment.length);
    if (end > 0.82 || end < 0.665) segment.direction.tensor = -segment.direction.tensor;
    if (const double other = segment.nu(segment.length); other > 0.82 || other < 0.665)
      segment.direction.tensor -= Eigen::Matrix3d::Identity() * (segment.direction.tensor.trace() / 3);
    nu = segment.nu(segment.length);
    strain = segment.strain(segment.length);
    path.push_back(segment);
  }
  return path;
}

/// The path as seen from other axes: each tensor T as R T R^T.
inline std::vector<StraightSegment> turned(std::vector<StraightSegment> path, const Eigen::Matrix3d& R) {
  for (StraightSegment& segment : path) {
    const auto turn = [&R](const Eigen::Matrix3d& T) { return Eigen::Matrix3d(R * T * R.transpose()); };
    const Eigen::Matrix3d D = turn(segment.direction.tensor), W = turn(segment.spin);
    segment.direction.tensor = (D + D.transpose()) / 2;
    segment.spin = (W - W.transpose()) / 2;
    segment.strain_start.tensor = turn(segment.strain_start.tensor);
  }
  return path;
}

}  // namespace grainlaw::testing
