#include <fmt/format.h>

#include "dem/export/snapshot.hpp"

namespace grainlaw::dem {
namespace {

/// One array of a file, its numbers as they come.
class DataArray {
 public:
  DataArray(const char* type, const char* name, int components)
      : text_(fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", type,
                          name, components)) {}
  template <class Number>
  void add(Number value) {
    fmt::format_to(std::back_inserter(text_), "{} ", value);
  }
  void add(const Eigen::Vector3d& v) { fmt::format_to(std::back_inserter(text_), "{} {} {}\n", v[0], v[1], v[2]); }
  std::string text() const { return text_ + "\n</DataArray>\n"; }

 private:
  std::string text_;
};

std::string file_text(const Snapshot& snapshot, std::size_t points, std::size_t lines, const std::string& content) {
  const Eigen::Matrix3d& H = snapshot.packing.H;
  return fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n<PolyData>\n<FieldData>\n"
      "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n"
      "<DataArray type=\"Float64\" Name=\"cell\" NumberOfTuples=\"9\" format=\"ascii\">{} {} {} {} {} {} {} {} "
      "{}</DataArray>\n"
      "</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n{}</Piece>\n</PolyData>\n</VTKFile>\n",
      snapshot.time, H(0, 0), H(0, 1), H(0, 2), H(1, 0), H(1, 1), H(1, 2), H(2, 0), H(2, 1), H(2, 2), points,
      lines == 0 ? points : 0, lines, content);
}

}  // namespace

std::string vtp_spheres(const Snapshot& snapshot) {
  const Packing& p = snapshot.packing;
  DataArray x("Float64", "Points", 3), id("Int64", "id", 1), r("Float64", "radius", 1), v("Float64", "velocity", 3),
      connectivity("Int64", "connectivity", 1), offsets("Int64", "offsets", 1);
  for (std::size_t i = 0; i < p.size(); ++i) {
    x.add(snapshot.position(i));
    id.add(p.id[i]);
    r.add(p.radius[i]);
    v.add(snapshot.velocity(i));
    connectivity.add(i);
    offsets.add(i + 1);
  }
  return file_text(snapshot, p.size(), 0,
                   "<PointData Scalars=\"radius\">\n" + id.text() + r.text() + v.text() + "</PointData>\n<Points>\n" +
                       x.text() + "</Points>\n<Verts>\n" + connectivity.text() + offsets.text() + "</Verts>\n");
}

std::string vtp_contacts(const Snapshot& snapshot) {
  const Packing& p = snapshot.packing;
  DataArray x("Float64", "Points", 3), id1("Int64", "id1", 1), id2("Int64", "id2", 1), piece("Int64", "piece", 1),
      branch("Float64", "branch", 3), force("Float64", "force", 3), size("Float64", "force_magnitude", 1),
      overlap("Float64", "overlap", 1), connectivity("Int64", "connectivity", 1), offsets("Int64", "offsets", 1);
  std::size_t lines = 0;
  for (const SnapshotContact& contact : snapshot.contacts) {
    std::size_t count = 0;
    for (const auto& [from, to] : pieces_in_cell(snapshot, contact)) {
      x.add(from);
      x.add(to);
      id1.add(p.id[contact.i]);
      id2.add(p.id[contact.j]);
      piece.add(count++);
      branch.add(contact.branch);
      force.add(contact.force);
      size.add(contact.force.norm());
      overlap.add(contact.overlap);
      connectivity.add(2 * lines);
      connectivity.add(2 * lines + 1);
      offsets.add(2 * ++lines);
    }
  }
  return file_text(snapshot, 2 * lines, lines,
                   "<CellData Scalars=\"force_magnitude\">\n" + id1.text() + id2.text() + piece.text() + branch.text() +
                       force.text() + size.text() + overlap.text() + "</CellData>\n<Points>\n" + x.text() +
                       "</Points>\n<Lines>\n" + connectivity.text() + offsets.text() + "</Lines>\n");
}

std::string pvd(const std::vector<std::pair<double, std::string>>& files) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (const auto& [time, name] : files)
    text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", time, name);
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace grainlaw::dem
