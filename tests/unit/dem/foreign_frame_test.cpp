#include "dem/foreign/foreign_frame.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

class ForeignFrameTest : public testing::TemporaryFolder {
 protected:
  using Open = std::unique_ptr<ForeignReader> (*)(const std::filesystem::path&);

  std::vector<ForeignFrame> read(Open open, const std::string& text) {
    std::vector<ForeignFrame> frames;
    const auto reader = open(put("file", text));
    for (ForeignFrame frame; reader->next(frame);) frames.push_back(frame);
    return frames;
  }

  void expect_refused(Open open, const std::string& text, const std::string& why) {
    const std::string message = testing::refusal([&] { read(open, text); });
    EXPECT_NE(message.find(why), std::string::npos) << message << "\nof\n" << text;
    EXPECT_NE(message.find("file"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
};

const std::string kDump =
    "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n-1 9\n0 10\n1 1.2e1\n"
    "ITEM: ATOMS id element x y z radius\n7 Si 1 2 3 .5\n8 O 4 5 6 .25\n";

TEST_F(ForeignFrameTest, DumpOfLammps) {
  const auto frames = read(read_lammps_dump, kDump + kDump);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].step, 100);
  EXPECT_EQ(frames[1].H->diagonal(), Eigen::Vector3d(10, 10, 11));
  EXPECT_EQ(frames[1].origin, Eigen::Vector3d(-1, 0, 1));
  EXPECT_EQ(frames[1].table.rows(), 2u);
  EXPECT_EQ(frames[1].table.values[11], .25);
  EXPECT_TRUE(std::isnan(frames[1].table.values[1])) << "a word that is no number";
  EXPECT_EQ(frames[1].table.first_line, 21u);
}

// lo_bound = lo + min(0, xy, xz, xy + xz), hi_bound = hi + max(...), so of lo 0, hi 10 and tilts -2, 1, 3:
TEST_F(ForeignFrameTest, TiltedBoxOfLammps) {
  std::string text = kDump;
  text.replace(text.find("pp pp"), 8, "xy xz yz pp pp pp");
  text.replace(text.find("-1 9\n0 10\n1 1.2e1"), 17, "-2 11 -2\n0 13 1\n0 10 3");
  const auto frames = read(read_lammps_dump, text);
  Eigen::Matrix3d H;
  H << 10, -2, 1, 0, 10, 3, 0, 0, 10;
  EXPECT_EQ(*frames[0].H, H);
  EXPECT_EQ(frames[0].origin, Eigen::Vector3d::Zero());
}

TEST_F(ForeignFrameTest, DumpsThatLieAreRefused) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kDump;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  expect_refused(read_lammps_dump, "", "line 1: the file is empty");
  expect_refused(read_lammps_dump, with("ATOMS\n2", "ATOMS\n1000000000000000000"),
                 "line 4: '1000000000000000000' is no number of rows");
  expect_refused(read_lammps_dump, with("ATOMS\n2", "ATOMS\n-2"), "is no number of rows");
  expect_refused(read_lammps_dump, with("ATOMS\n2", "ATOMS\n99999999"), "the file ends after 2 of 99999999 rows");
  expect_refused(read_lammps_dump, with("ATOMS\n2", "ATOMS\n1"), "where an ITEM: must begin");
  expect_refused(read_lammps_dump, with("8 O 4 5 6 .25", "8 O 4 5"), "line 11: has 4 words where the frame has 6");
  expect_refused(read_lammps_dump, with("pp pp pp", "pp ff pp"), "boundary 'ff' is not periodic");
  expect_refused(read_lammps_dump, with("-1 9", "-1 nan"), "'nan' is no finite number");
  expect_refused(read_lammps_dump, with("TIMESTEP\n100", "TIMESTEP\nx"), "line 2: 'x' is no number");
  expect_refused(read_lammps_dump, kDump.substr(0, 60), "file");
  expect_refused(read_lammps_dump, std::string("ITEM: TIMESTEP\n1\0", 17), "NUL byte");
}

TEST_F(ForeignFrameTest, ExtendedXyz) {
  const std::string text =
      "2\nLattice=\"10 0 0 1 11 0 2 3 12\" Properties=species:S:1:pos:R:3:radius:R:1 pbc=\"T T T\" Time=1.5\n"
      "Si 1 2 3 .5\nO 4 5 6 .25\n";
  const auto frames = read(read_extended_xyz, text + text);
  ASSERT_EQ(frames.size(), 2u);
  Eigen::Matrix3d H;
  H << 10, 1, 2, 0, 11, 3, 0, 0, 12;
  EXPECT_EQ(*frames[0].H, H);
  EXPECT_EQ(frames[0].time, 1.5);
  EXPECT_EQ(frames[0].table.columns, (std::vector<std::string>{"species", "pos_x", "pos_y", "pos_z", "radius"}));
  expect_refused(read_extended_xyz, "2\n\nH 0 0 0\nH 1 1 1\n", "line 2: misses Properties=");
  expect_refused(read_extended_xyz, "2\npbc=\"T T F\" Properties=pos:R:3\n", "averages need a periodic cell");
  expect_refused(read_extended_xyz, "9\nProperties=pos:R:3\n1 2 3\n", "the file ends after 1 of 9 rows");
  expect_refused(read_extended_xyz, "1\nProperties=pos:R:x\n1 2 3\n", "NAME:TYPE:COLUMNS");
  expect_refused(read_extended_xyz, "1\nLattice=\"1 2\" Properties=pos:R:3\n1 2 3\n", "is not 9 numbers");
}

TEST_F(ForeignFrameTest, TextOfYade) {
  const auto frames = read(read_text_table, "#format x_y_z_r\n1\t2\t3\t.5\n4\t5\t6\t.25\n");
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].table.columns, (std::vector<std::string>{"x", "y", "z", "r"}));
  EXPECT_EQ(frames[0].table.values[7], .25);
}

// Two points in text, in base64 as a whole and with the header by itself, as VTK writes it; compressed in tests/cli/export.sh.
TEST_F(ForeignFrameTest, RefusalsAreOneLineOfText) {
  ForeignFrame frame;
  frame.file = "file";
  frame.place = "step\t1";
  const std::string message = frame.refusal("has no column 'id', but a\r, b\x1b[2J", 3, "x\ny").what();
  EXPECT_TRUE(message.starts_with("file: step")) << message;
  for (const char c : message) EXPECT_GE(c, ' ') << message;
}

TEST_F(ForeignFrameTest, PolyDataOfVtk) {
  const auto file = [](const std::string& points, const std::string& radius) {
    return "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" header_type=\"UInt32\"><PolyData><Piece "
           "NumberOfPoints=\"2\">"
           "<PointData><DataArray type=\"Float32\" Name=\"radius\" " +
           radius +
           "</DataArray></PointData>"
           "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" " +
           points +
           "</DataArray></Points>"
           "</Piece></PolyData></VTKFile>";
  };
  const std::string points = "format=\"ascii\">1 2 3\n4 5 6";
  // [8][.5f, .25f]
  for (const char* radius :
       {"format=\"ascii\"> .5 .25 ", "format=\"binary\">CAAAAAAAAD8AAIA+", "format=\"binary\">CAAAAA==AAAAPwAAgD4="}) {
    const auto frames = read(read_vtk_xml, file(points, radius));
    EXPECT_EQ(frames[0].table.columns, (std::vector<std::string>{"Points_x", "Points_y", "Points_z", "radius"}));
    EXPECT_EQ(frames[0].table.values, (std::vector<double>{1, 2, 3, .5, 4, 5, 6, .25})) << radius;
  }
  const std::string good = "format=\"ascii\"> .5 .25 ";
  expect_refused(read_vtk_xml, file(points, "format=\"binary\">CAAAAAAAAD8AA"), "does not hold the 8 bytes");
  expect_refused(read_vtk_xml, file(points, "format=\"binary\">////fwAAAD8AAIA+"), "does not hold the 8 bytes");
  expect_refused(read_vtk_xml, file(points, "format=\"ascii\">.5"), "1 numbers where 2 must be");
  expect_refused(read_vtk_xml, file(points, "format=\"appended\" offset=\"99\">"), "outside the appended data");
  expect_refused(read_vtk_xml, file(points, good).substr(0, 150), "is it a VTK file in XML, and whole?");
  std::string lie = file(points, good);
  lie.replace(lie.find("Points=\"2\""), 10, "Points=\"1000000000000\"");
  expect_refused(read_vtk_xml, lie, "is no whole number, 0 to 1e8");
  expect_refused(read_vtk_xml, "<html></html>", "type '' is not read");
}

}  // namespace
}  // namespace grainlaw::dem
