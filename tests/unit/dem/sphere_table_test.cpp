#include "dem/files/sphere_table.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "dem/engine/neighbour_list.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

class SphereTable : public ::testing::Test {
 protected:
  SphereTable() : file_(fs::temp_directory_path() / ("grainlaw-spheres-" + std::to_string(::getpid()) + ".csv")) {}
  ~SphereTable() override { fs::remove(file_); }

  void put(const std::string& content) const { std::ofstream(file_, std::ios::binary) << content; }
  State read(const std::string& content) const {
    put(content);
    return read_spheres(file_, scene::cubic(0.01), {});
  }
  std::string refusal(const std::string& content) const {
    put(content);
    try {
      read_spheres(file_, scene::cubic(0.01), {});
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path file_;
};

constexpr const char* kGood = "id,x,y,z,r\n1,0.001,0.002,0.003,0.001\n2,0.005,0.005,0.005,0.0005\n";

#define EXPECT_REFUSED(content, row, what)                                 \
  do {                                                                     \
    const std::string message = refusal(content);                          \
    EXPECT_NE(message.find(file_.string()), std::string::npos) << message; \
    EXPECT_NE(message.find(row), std::string::npos) << message;            \
    EXPECT_NE(message.find(what), std::string::npos) << message;           \
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;           \
  } while (false)

TEST_F(SphereTable, ReadsPositionsInMetres) {
  const State state = read(kGood);
  const Packing& p = state.packing;
  ASSERT_EQ(p.size(), 2u);
  EXPECT_EQ(p.id, (std::vector<std::int64_t>{1, 2}));
  EXPECT_TRUE(scene::position(p, 0).isApprox(Eigen::Vector3d(0.001, 0.002, 0.003), 1e-15));
  EXPECT_EQ(p.radius[1], 0.0005);
  EXPECT_DOUBLE_EQ(p.mass[1], sphere_mass({}, 0.0005));
  EXPECT_EQ(kinetic_energy(p), 0);
}

TEST_F(SphereTable, TakesColumnsInAnyOrderWithUnitsSpacesCrlfAndMark) {
  const State state = read(
      "\xef\xbb\xbf"
      "r[m], vy[m/s],vx[m/s],vz[m/s],z[m],y[m],x[m],id\r\n"
      "0.001 ,\t2,1,3,0.004,0.005,0.006,-9\r\n\r\n");
  const Packing& p = state.packing;
  ASSERT_EQ(p.size(), 1u);
  EXPECT_EQ(p.id[0], -9);
  EXPECT_EQ(scene::velocity(p, 0), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(scene::position(p, 0).isApprox(Eigen::Vector3d(0.006, 0.005, 0.004), 1e-15));
}

TEST_F(SphereTable, ReadsBackWhatItWrote) {
  scene::Draw draw(4);
  Eigen::Matrix3d shape;
  shape << 1, 0.6, -0.3, 0, 0.8, 0.5, 0, 0, 1.3;
  State state = scene::random_state(50, 3, 0.6, shape, draw);
  scene::random_velocities(state.packing, 1, draw);
  scene::place(state.packing, 0, {-3.25, 1.5, 7.0});  // unwrapped
  write_spheres(file_, state.packing);
  const State again = read_spheres(file_, state.packing.H, state.material);
  Packing wrapped = state.packing;
  wrap(wrapped);
  EXPECT_EQ(again.packing.id, wrapped.id);
  EXPECT_EQ(again.packing.radius, wrapped.radius);
  EXPECT_EQ(again.packing.mass, wrapped.mass);
  EXPECT_EQ(again.packing.vx, wrapped.vx);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_LE((scene::fraction(again.packing, i) - scene::fraction(wrapped, i)).norm(), 1e-15);
  }
}

TEST_F(SphereTable, RefusesABrokenHeader) {
  EXPECT_REFUSED("", "line 1", "empty");
  EXPECT_REFUSED("1,0.001,0.002,0.003,0.001\n", "line 1", "no column");
  EXPECT_REFUSED("id;x;y;z;r\n1;0;0;0;1\n", "line 1", "commas");
  EXPECT_REFUSED("id,x,y,z\n1,0,0,0\n", "column r", "missing");
  EXPECT_REFUSED("id,x,y,z,r,x\n", "column x", "twice");
  EXPECT_REFUSED("id,x,y,z,r,mass\n", "'mass'", "no column");
  EXPECT_REFUSED("id,x[mm],y[mm],z[mm],r[mm]\n", "column x", "[mm]");
  EXPECT_REFUSED("id,x,y,z,r,vx\n", "vx, vy, vz", "all three");
  std::string columns = "id";
  for (int i = 0; i < 400000; ++i) columns += ",x";
  EXPECT_REFUSED(columns + "\n", "line 1", "twice");
}

TEST_F(SphereTable, RefusesABrokenRow) {
  const std::string header = "id,x,y,z,r\n1,0,0,0,0.001\n";
  EXPECT_REFUSED(header + "2,0,0,0\n", "line 3", "4 fields");
  EXPECT_REFUSED(header + "2,0,0,0,0.001,7\n", "line 3", "6 fields");
  EXPECT_REFUSED(header + "2,0,005,0,0,0,001\n", "line 3", "decimal comma");
  EXPECT_REFUSED(header + "2,nan,0,0,0.001\n", "line 3, column x", "not finite");
  EXPECT_REFUSED(header + "2,0,-inf,0,0.001\n", "line 3, column y", "not finite");
  EXPECT_REFUSED(header + "2,0,0,1e999,0.001\n", "line 3, column z", "no number");
  EXPECT_REFUSED(header + "2,0,0,0x10,0.001\n", "line 3, column z", "no number");
  EXPECT_REFUSED(header + "2,0,,0,0.001\n", "line 3, column y", "no number");
  EXPECT_REFUSED(header + "2.5,0,0,0,0.001\n", "line 3, column id", "no integer");
  EXPECT_REFUSED(header + "99999999999999999999,0,0,0,0.001\n", "line 3, column id", "no integer");
  EXPECT_REFUSED(header + "1,0.005,0,0,0.001\n", "line 3, column id", "already in line 2");
  EXPECT_REFUSED(header + "2,0,0,0,0\n", "line 3, column r", "not positive");
  EXPECT_REFUSED(header + "2,0,0,0,-0.001\n", "line 3, column r", "not positive");
  EXPECT_REFUSED(header + std::string("2,0,0,0,0.0\0001\n", 14), "line 3", "NUL");
  EXPECT_REFUSED(header + "2,0,0,0,1e-150\n", "sphere 2", "mass");  // its cube is zero
  EXPECT_REFUSED(header + "\n2,0,0,0,0.001\n", "line 4", "empty line");
  EXPECT_REFUSED(header + "2,1e6,0,0,0.001\n", "line 3", "metres");
  EXPECT_REFUSED(header + std::string(1'100'000, '1') + "\n", "line 3", "1 MB");
}

TEST_F(SphereTable, RefusesWhatIsNoPacking) {
  EXPECT_REFUSED("id,x,y,z,r\n", "line 1", "no spheres");
  EXPECT_REFUSED("id,x,y,z,r\n1,0,0,0,1\n", "radius 1", "metres");
  EXPECT_REFUSED("id,x,y,z,r\n1,0,0,0,0.009\n", "fill", "metres");
  put(kGood);
  Eigen::Matrix3d lower = scene::cubic(0.01);
  lower(1, 0) = 0.001;
  EXPECT_THROW(read_spheres(file_, lower, {}), InvalidInput);
  EXPECT_THROW(read_spheres(file_, scene::cubic(-0.01), {}), InvalidInput);
  EXPECT_THROW(read_spheres(fs::temp_directory_path(), scene::cubic(0.01), {}), InvalidInput);
  EXPECT_THROW(read_spheres(file_.string() + ".none", scene::cubic(0.01), {}), InvalidInput);
}

}  // namespace
}  // namespace grainlaw::dem
