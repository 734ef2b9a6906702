#include "dem/foreign/particle_request.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cstring>

#include "dem/files/state_file.hpp"
#include "model/files/reading.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

/// Files of the folder that fit a name with '*', "a9" before "a10".
std::vector<fs::path> fitting(const fs::path& pattern) {
  std::vector<fs::path> found;
  const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  for (const fs::path& entry : entries_of(folder)) {
    if (::fnmatch(pattern.filename().c_str(), entry.filename().c_str(), FNM_PERIOD) == 0)
      found.push_back(folder / entry.filename());
  }
  std::sort(found.begin(), found.end(),
            [](const fs::path& a, const fs::path& b) { return ::strverscmp(a.c_str(), b.c_str()) < 0; });
  return found;
}

std::vector<fs::path> files_of(const Json& names, const fs::path& folder, const std::string& where) {
  std::vector<fs::path> files;
  for (const Json& name : names) {
    const fs::path file = folder / name.get<std::string>();
    if (file.filename().string().find('*') == std::string::npos) {
      files.push_back(file);
      continue;
    }
    const std::vector<fs::path> found = fitting(file);
    if (found.empty()) throw InvalidInput(fmt::format("{}: files: no file fits {}", where, file.string()));
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

void take_titles(const Json& json, const char* key, std::array<std::string, 3>& titles) {
  if (json.contains(key)) titles = json[key].get<std::array<std::string, 3>>();
}

ContactRequest contact_request(const Json& json, const fs::path& folder, const std::string& where) {
  ContactRequest contacts;
  if (!json.contains("files")) throw InvalidInput(where + ": misses the key 'files'; name those with the contacts");
  contacts.format = value_of<ParticleFormat>(json.value("format", "lammps-dump"), "format");
  contacts.files = files_of(json["files"], folder, where);
  contacts.first = json.value("first", contacts.first);
  contacts.second = json.value("second", contacts.second);
  take_titles(json, "force", contacts.force);
  take_titles(json, "tangential_force", contacts.tangential);
  take_titles(json, "branch", contacts.branch);
  contacts.on_second = json.value("force_on", "first") == "second";
  return contacts;
}

Eigen::Matrix3d cell_of(const std::array<double, 6>& lengths_and_tilts, const std::string& where) {
  const auto& [lx, ly, lz, xy, xz, yz] = lengths_and_tilts;
  Eigen::Matrix3d H;
  H << lx, xy, xz, 0, ly, yz, 0, 0, lz;
  if (!H.allFinite() || !(H.diagonal().minCoeff() > 0))
    throw InvalidInput(where + ": the edges of a cell must be positive and finite");
  return H;
}

/// The cells of a table, with the times where it has them.
void read_cells(const Json& json, const fs::path& folder, ParticleRequest& request) {
  ForeignFrame frame;
  read_text_table(folder / json["file"].get<std::string>())->next(frame);
  const NumberTable& table = frame.table;
  const auto column = [&](const std::string& title) {
    const auto at = std::find(table.columns.begin(), table.columns.end(), title);
    if (at == table.columns.end()) throw frame.refusal("misses the column; name it in 'cells'", 0, title);
    return static_cast<std::size_t>(at - table.columns.begin());
  };
  std::array<std::string, 3> lengths{"lx", "ly", "lz"}, tilts{};
  take_titles(json, "lengths", lengths);
  take_titles(json, "tilts", tilts);
  const std::string time = json.value("time", "");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto value = [&](const std::string& title) {
      const double number = table.values[row * table.columns.size() + column(title)];
      if (!std::isfinite(number)) throw frame.refusal("is no finite number", row + 1, title);
      return number;
    };
    std::array<double, 6> edges{};
    for (std::size_t a = 0; a < 3; ++a) {
      edges[a] = value(lengths[a]) * request.length;
      edges[a + 3] = tilts[a].empty() ? 0 : value(tilts[a]) * request.length;
    }
    request.cells.push_back(cell_of(edges, frame.where(row + 1)));
    if (!time.empty()) request.times.push_back(value(time) * request.time);
  }
}

class StateReader : public ForeignReader {
 public:
  explicit StateReader(fs::path file) : file_(std::move(file)) {}

  bool next(ForeignFrame& frame) override {
    if (read_) return false;
    read_ = true;
    const State state = read_state(file_);
    const Packing& p = state.packing;
    frame = {};
    frame.file = file_;
    frame.time = state.time;
    frame.H = p.H;
    frame.table.columns = {"id", "x", "y", "z", "r", "vx", "vy", "vz"};
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Eigen::Vector3d x = p.H * Eigen::Vector3d(p.sx[i], p.sy[i], p.sz[i]);
      for (const double value :
           {static_cast<double>(p.id[i]), x[0], x[1], x[2], p.radius[i], p.vx[i], p.vy[i], p.vz[i]})
        frame.table.values.push_back(value);
    }
    return true;
  }

 private:
  fs::path file_;
  bool read_ = false;
};

std::unique_ptr<ForeignReader> reader_of(ParticleFormat format, const fs::path& file) {
  switch (format) {
    case ParticleFormat::lammps_dump:
      return read_lammps_dump(file);
    case ParticleFormat::xyz:
      return read_extended_xyz(file);
    case ParticleFormat::vtk:
      return read_vtk_xml(file);
    case ParticleFormat::table:
      return read_text_table(file);
    case ParticleFormat::state:
      return std::make_unique<StateReader>(file);
  }
  throw Error("no such format of particles");
}

}  // namespace

ParticleRequest particle_request(const Json& json, const fs::path& folder, const std::string& where) {
  ParticleRequest request;
  request.where = where;
  for (const char* key : {"format", "files"}) {
    if (!json.contains(key)) throw InvalidInput(fmt::format("{}: misses the key '{}'", where, key));
  }
  request.format = value_of<ParticleFormat>(json["format"].get<std::string>(), "format");
  request.files = files_of(json["files"], folder, where);
  if (json.contains("units")) {
    for (const auto& [key, unit] :
         {std::pair{"length", &request.length}, {"time", &request.time}, {"force", &request.force}})
      *unit = json["units"].value(key, 1.0);
  }
  if (json.contains("columns")) {
    const Json& columns = json["columns"];
    SphereColumns& c = request.columns;
    for (const auto& [key, title] : {std::pair{"id", &c.id},
                                     {"x", &c.x},
                                     {"y", &c.y},
                                     {"z", &c.z},
                                     {"r", &c.r},
                                     {"diameter", &c.diameter},
                                     {"vx", &c.vx},
                                     {"vy", &c.vy},
                                     {"vz", &c.vz}})
      *title = columns.value(key, "");
  }
  if (json.contains("contacts")) request.contacts = contact_request(json["contacts"], folder, where + ".contacts");
  request.time_step = json.value("time_step", request.time_step);
  request.stiffness = json.value("stiffness", request.stiffness);
  request.density = json.value("density", request.density);
  request.contact_viscosity = json.value("contact_viscosity", 0.0);
  if (json.contains("cell") && json.contains("cells"))
    throw InvalidInput(where + ": cell and cells exclude each other; give one");
  if (json.contains("cell")) {
    std::array<double, 6> edges{};
    for (std::size_t a = 0; a < json["cell"].size(); ++a) edges[a] = json["cell"][a].get<double>() * request.length;
    request.cells.push_back(cell_of(edges, where + ": cell"));
  }
  if (json.contains("cells")) read_cells(json["cells"], folder, request);
  if (json.contains("times")) {
    request.times = json["times"].get<std::vector<double>>();
    for (double& time : request.times) time *= request.time;
  }
  if (request.format == ParticleFormat::state) {
    const State state = read_state(request.files.front());
    const Material& material = state.material;
    if (!std::isnan(request.stiffness) && std::abs(request.stiffness / material.stiffness - 1) > 1e-9)
      throw InvalidInput(fmt::format("{}: stiffness: is {} but {} was made with {}; remove the key", where,
                                     request.stiffness, request.files.front().string(), material.stiffness));
    if (!(state.contacts == ContactModel{}) && !request.contacts)
      throw InvalidInput(
          fmt::format("{}: {} was made with other contacts than k delta; give 'contacts' with the forces", where,
                      request.files.front().string()));
    request.stiffness = material.stiffness;
    if (std::isnan(request.density)) request.density = material.density;
    if (!request.contacts && !json.contains("contact_viscosity"))
      request.contact_viscosity = material.contact_viscosity;
  }
  if (std::isnan(request.stiffness))
    throw InvalidInput(where + ": misses the key 'stiffness'; give k [kg/s^2], the unit of P* is k/(2<r>)");
  if (request.contacts && request.contact_viscosity != 0)
    throw InvalidInput(where +
                       ": contact_viscosity: belongs to the declared law, but 'contacts' give the forces; remove one");
  return request;
}

bool FrameFiles::next(ForeignFrame& frame) {
  for (;;) {
    if (reader_ && reader_->next(frame)) return true;
    if (opened_ == files_.size()) return false;
    reader_ = reader_of(format_, files_[opened_]);
    ++opened_;
  }
}

}  // namespace grainlaw::dem
