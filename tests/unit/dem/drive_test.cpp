#include "dem/element_tests/drive.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "model/vocabulary/error.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

using std::numbers::pi;

const Eigen::Matrix3d kCell = Eigen::Vector3d(9e-3, 10e-3, 11e-3).asDiagonal();

Drive drive_of(Mode mode, bool reverse, double length, Profile profile = Profile::cosine) {
  StraightSegment segment = scene::segment_of(direction_of(mode, "xyz", reverse).tensor, length, 0.7);
  segment.mode = mode;
  DriveOptions options;
  options.profile = profile;
  return make_drive(segment, options, kCell);
}

// Eq. (2): z(t) = z_f + (z_0 - z_f)/2 (1 + cos(pi t/tau)) for the compressed edge.
TEST(Drive, CosineMovesTheCompressedEdge) {
  for (const Mode mode : {Mode::ISO, Mode::UNI, Mode::D2, Mode::D3}) {
    const Drive drive = drive_of(mode, false, 0.2);
    const double z_0 = kCell(2, 2), z_f = z_0 * std::exp(-0.2);
    for (const double u : {0.0, 0.1, 0.5, 0.77, 1.0}) {
      const double z = z_f + (z_0 - z_f) / 2 * (1 + std::cos(pi * u));
      EXPECT_NEAR(motion_at(drive, u * drive.duration).H(2, 2), z, 1e-15 * z_0) << to_string(mode) << " at " << u;
    }
  }
}

TEST(Drive, CosineMovesTheStretchedEdgeWhereNoneShrinks) {
  const Drive drive = drive_of(Mode::UNI, true, 0.2);
  const double z_0 = kCell(2, 2), z_f = z_0 * std::exp(0.2);
  EXPECT_NEAR(motion_at(drive, drive.duration / 3).H(2, 2), z_f + (z_0 - z_f) * 0.75, 1e-15 * z_f);
}

TEST(Drive, EndsAreExact) {
  for (const Profile profile : {Profile::cosine, Profile::constant}) {
    const Drive drive = drive_of(Mode::D2, false, 0.17, profile);
    EXPECT_EQ(path_parameter(drive, 0), 0);
    EXPECT_EQ(path_parameter(drive, drive.duration), 0.17);
    EXPECT_EQ(motion_at(drive, 0).H, kCell);
    const double stretch = std::exp(0.17);
    EXPECT_NEAR(motion_at(drive, drive.duration).H(0, 0), kCell(0, 0) * stretch, 1e-17);
    EXPECT_EQ(motion_at(drive, drive.duration).H(1, 1), kCell(1, 1));
  }
}

// To the last bit, on which the bits of a run depend: vectors of two edges and a third alone once took two kinds of exp.
TEST(Drive, AnEdgeIsStretchedTheSameWhateverItsName) {
  const double rate[] = {-1, 0.3, 0.7};
  for (const char* axes : {"xyz", "yzx", "zxy"}) {
    Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) tensor(axes[k] - 'x', axes[k] - 'x') = rate[k];
    const StraightSegment segment = scene::segment_of(tensor, 0.2, 0.7);
    for (int i = 0; i <= 1000; ++i) {
      const double e = 2e-4 * i;
      const Eigen::Vector3d stretch = stretch_of(segment, e);
      for (int k = 0; k < 3; ++k) ASSERT_EQ(stretch(axes[k] - 'x'), std::exp(e * rate[k])) << axes << ", edge " << k;
    }
  }
}

TEST(Drive, ConstantVolumeModesKeepTheVolume) {
  for (const Mode mode : {Mode::D2, Mode::D3}) {
    for (const bool reverse : {false, true}) {
      const Drive drive = drive_of(mode, reverse, 0.3);
      for (int k = 0; k <= 100; ++k) {
        EXPECT_NEAR(motion_at(drive, k * drive.duration / 100).H.determinant() / kCell.determinant(), 1, 1e-14);
      }
    }
  }
}

// L = dH/dt H^-1, by central difference of H; the difference errs by (pi h/tau)^2/6 of it.
TEST(Drive, VelocityGradientIsTheRateOfTheCell) {
  for (const Profile profile : {Profile::cosine, Profile::constant}) {
    for (const Mode mode : {Mode::ISO, Mode::UNI, Mode::D2, Mode::D3}) {
      const Drive drive = drive_of(mode, false, 0.2, profile);
      const double tau = drive.duration, h = 1e-4 * tau;
      for (const double u : {0.001, 0.2, 0.5, 0.9}) {
        const Eigen::Matrix3d rate = (motion_at(drive, u * tau + h).H - motion_at(drive, u * tau - h).H) / (2 * h);
        const CellMotion motion = motion_at(drive, u * tau);
        EXPECT_LE((motion.L * motion.H - rate).norm(), 1e-6 * kCell.norm() / tau) << to_string(mode) << " at " << u;
      }
    }
  }
}

TEST(Drive, DurationFollowsFromThePeakRate) {
  // g = max(|eps_vol|, eps_dev): ISO 3 e, UNI e, D2 sqrt(3) e, D3 1.5 e
  const DriveOptions options;
  for (const auto& [mode, g] :
       {std::pair{Mode::ISO, 3.0}, {Mode::UNI, 1.0}, {Mode::D2, std::sqrt(3.0)}, {Mode::D3, 1.5}}) {
    EXPECT_NEAR(drive_of(mode, false, 0.1).duration, pi / 2 * g * 0.1 / options.strain_rate, 1e-16);
    EXPECT_NEAR(drive_of(mode, false, 0.1, Profile::constant).duration, g * 0.1 / options.strain_rate, 1e-16);
  }
  // For small strain the logarithmic rate is the cosine's own, with its peak at the middle.
  const Drive small = drive_of(Mode::UNI, false, 1e-4);
  EXPECT_NEAR(path_parameter_rate(small, small.duration / 2), options.strain_rate, 1e-3 * options.strain_rate);
  const Drive steady = drive_of(Mode::D2, false, 0.3, Profile::constant);
  EXPECT_NEAR(path_parameter_rate(steady, 0.3 * steady.duration) * std::sqrt(3.0), options.strain_rate,
              1e-12 * options.strain_rate);
}

// Table of the paper: uniaxial compression 0.64 -> 0.82 within T/2 = 2500 us has its peak rate, per initial edge, at
// pi f (z_0 - z_f)/z_0 = 137.9 1/s.
TEST(Drive, PeakRateOfThePaper) {
  const double length = std::log(0.82 / 0.64);
  StraightSegment segment = scene::segment_of(direction_of(Mode::UNI).tensor, length, 0.64);
  DriveOptions options;
  options.strain_rate = pi / 2 * length / 2500e-6;  // so that tau = T/2
  const Drive drive = make_drive(segment, options, kCell);
  ASSERT_NEAR(drive.duration, 2500e-6, 1e-15);
  const CellMotion motion = motion_at(drive, drive.duration / 2);
  const double engineering = -motion.L(2, 2) * motion.H(2, 2) / kCell(2, 2);
  EXPECT_NEAR(engineering, pi / 5000e-6 * (1 - 0.64 / 0.82), 1e-9);
  EXPECT_NEAR(engineering, 137.9, 0.05);
}

TEST(Drive, TransportIsPassedOn) {
  StraightSegment segment = scene::segment_of(direction_of(Mode::ISO).tensor, 0.1, 0.7);
  DriveOptions options;
  options.transport = Transport::wall;
  EXPECT_EQ(motion_at(make_drive(segment, options, kCell), 0).transport, Transport::wall);
}

TEST(Drive, RefusesWhatItCannotDrive) {
  StraightSegment segment = scene::segment_of(direction_of(Mode::D2).tensor, 0.1, 0.7);
  for (const double rate :
       {0.0, -138.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    DriveOptions options;
    options.strain_rate = rate;
    EXPECT_THROW(make_drive(segment, options, kCell), InvalidInput) << rate;
  }
  segment.direction.tensor(0, 1) = segment.direction.tensor(1, 0) = 0.1;
  EXPECT_THROW(make_drive(segment, DriveOptions{}, kCell), InvalidInput);
}

}  // namespace
}  // namespace grainlaw::dem
