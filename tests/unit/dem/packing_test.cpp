#include "dem/engine/packing.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <functional>
#include <string>

#include "model/vocabulary/error.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw::dem {
namespace {

using testing::kInfinity;
using testing::kNaN;

Packing two_spheres() {
  return scene::state_of(scene::cubic(10e-3),
                         {{1e-3, {2e-3, 3e-3, 4e-3}, {1, 2, 3}}, {2e-3, {7e-3, 8e-3, 9e-3}, {-1, 0, 1}}})
      .packing;
}

TEST(Packing, ResizeAllocatesZeroesAndIds) {
  Packing p;
  resize(p, 3);
  EXPECT_EQ(p.size(), 3U);
  EXPECT_EQ(p.id, (std::vector<std::int64_t>{0, 1, 2}));
  for (const auto* a : {&p.radius, &p.mass, &p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz}) {
    EXPECT_EQ(*a, std::vector<double>(3, 0.0));
  }
}

TEST(Packing, SizesAndVolumes) {
  Packing p = two_spheres();
  EXPECT_DOUBLE_EQ(mean_radius(p), 1.5e-3);
  EXPECT_DOUBLE_EQ(solid_volume(p), 4.0 / 3.0 * std::numbers::pi * 9e-9);
  EXPECT_DOUBLE_EQ(volume_fraction(p), solid_volume(p) / 1e-6);
  p.H << 1e-2, 5e-3, -3e-3, 0, 2e-2, 7e-3, 0, 0, 3e-2;
  EXPECT_DOUBLE_EQ(p.volume(), p.H.determinant());
  EXPECT_DOUBLE_EQ(p.mass[0], 2000 * 4.0 / 3.0 * std::numbers::pi * 1e-9);
  EXPECT_TRUE(std::isnan(mean_radius(Packing{})));
}

TEST(Packing, ScalingKeepsTheShapeOfTheCell) {
  Packing p = two_spheres();
  p.H << 1e-2, 5e-3, -3e-3, 0, 2e-2, 7e-3, 0, 0, 3e-2;
  const Eigen::Matrix3d shape = p.H / p.H(0, 0);
  scale_to_volume_fraction(p, 0.64);
  EXPECT_NEAR(volume_fraction(p), 0.64, 1e-15);
  EXPECT_LE((p.H / p.H(0, 0) - shape).norm(), 1e-15);
}

TEST(Packing, RemoveDriftLeavesNoMomentum) {
  Packing p = two_spheres();
  const double relative = p.vx[0] - p.vx[1];
  remove_drift(p);
  for (const auto* v : {&p.vx, &p.vy, &p.vz}) {
    EXPECT_NEAR(p.mass[0] * (*v)[0] + p.mass[1] * (*v)[1], 0, 1e-15 * p.mass[1]);
  }
  EXPECT_DOUBLE_EQ(p.vx[0] - p.vx[1], relative) << "all spheres are shifted alike";
}

TEST(Packing, CheckNamesSphereAndQuantity) {
  const auto message = [](const std::function<void(Packing&)>& damage) -> std::string {
    Packing p = two_spheres();
    p.id = {70, 71};
    damage(p);
    try {
      check(p);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message([](Packing&) {}), "accepted");
  for (const double bad : {0.0, -1e-3, kNaN, kInfinity}) {
    EXPECT_NE(message([&](Packing& p) { p.radius[1] = bad; }).find("sphere 71: radius"), std::string::npos);
    EXPECT_NE(message([&](Packing& p) { p.mass[0] = bad; }).find("sphere 70: mass"), std::string::npos);
  }
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_NE(message([&](Packing& p) { p.sy[1] = bad; }).find("sphere 71: position"), std::string::npos);
    EXPECT_NE(message([&](Packing& p) { p.vz[0] = bad; }).find("sphere 70: velocity"), std::string::npos);
  }
  EXPECT_NE(message([](Packing& p) { p.sx.pop_back(); }).find("length"), std::string::npos);
  EXPECT_NE(message([](Packing& p) { p.id.pop_back(); }).find("length"), std::string::npos);
  struct CellEntry {
    int row, column;
    double value;
  };
  const std::vector<CellEntry> bad_entries{{1, 0, 1e-3},  {2, 0, 1e-3}, {2, 1, 1e-3},     {0, 0, 0.0},
                                           {1, 1, -1e-2}, {0, 1, kNaN}, {2, 2, kInfinity}};
  for (const CellEntry& bad : bad_entries) {
    EXPECT_NE(message([&](Packing& p) { p.H(bad.row, bad.column) = bad.value; }).find("cell"), std::string::npos);
  }
}

TEST(Packing, MinCollisionTimeIsThatOfTheTwoLightest) {
  const Material material;
  Packing p;
  resize(p, 4);
  p.radius = {1.2e-3, 0.6e-3, 1.4e-3, 0.7e-3};
  set_masses(p, material);
  double least = kInfinity;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, collision_time(material, reduced_mass(p.mass[i], p.mass[j])));
  }
  EXPECT_DOUBLE_EQ(min_collision_time(p, material), least);
  resize(p, 1);
  p.radius = {1e-3};
  set_masses(p, material);
  EXPECT_DOUBLE_EQ(min_collision_time(p, material), collision_time(material, p.mass[0] / 2)) << "with its own image";
}

}  // namespace
}  // namespace grainlaw::dem
