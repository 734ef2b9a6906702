#include "chain/export.hpp"

#include <fmt/format.h>

#include "dem/export/snapshot.hpp"
#include "dem/export/vtkhdf.hpp"
#include "dem/files/sphere_table.hpp"
#include "dem/files/state_file.hpp"
#include "dem/runs/path_frames.hpp"
#include "model/files/csv_table.hpp"
#include "model/files/dataset.hpp"
#include "model/files/npz_writer.hpp"
#include "model/files/output.hpp"
#include "model/files/reading.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAllSeries = "series.csv";  // of csv

/// A state file of the source, with the motion of its cell where that is known.
struct StateSource {
  fs::path file;
  Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
};

std::vector<fs::path> files_with(const fs::path& folder, const char* extension) {
  std::vector<fs::path> files;
  for (const fs::path& entry : entries_of(folder)) {
    if (entry.extension() == extension && !entry.filename().string().starts_with('.')) files.push_back(entry);
  }
  return files;
}

std::vector<StateSource> states_of(const fs::path& source) {
  if (!fs::is_directory(source)) return {{source}};
  std::vector<StateSource> states;
  for (const dem::FramePlace& place : dem::read_frame_places(source)) {
    states.push_back({source / dem::frame_file(place.frame)});
    states.back().L.diagonal() << place.L_xx, place.L_yy, place.L_zz;
  }
  if (!states.empty()) return states;
  for (const fs::path& file : files_with(source, ".state")) states.push_back({file});
  if (states.empty())
    throw InvalidInput(
        fmt::format("{}: holds no states; give a state file or a folder of grainlaw simulate (with --frames), "
                    "or --format npz or csv for the series of a data set",
                    source.string()));
  return states;
}

/// Writes the files of one export and knows their names.
class Export {
 public:
  Export(ExportFormat format, const fs::path& output) : format_(format), output_(output) {}

  void add_state(const StateSource& source, bool alone) {
    const dem::State state = dem::read_state(source.file);
    const dem::Snapshot snapshot = dem::snapshot_of(state, source.L);
    const std::string name = source.file.stem().string();
    const std::string all = alone ? name : "frames";
    ++done_.states;
    switch (format_) {
      case ExportFormat::vtp:
        write(name + ".spheres.vtp", vtp_spheres(snapshot));
        spheres_.emplace_back(state.time, done_.files.back());
        write(name + ".contacts.vtp", vtp_contacts(snapshot));
        contacts_.emplace_back(state.time, done_.files.back());
        break;
      case ExportFormat::xyz:
        append(all + ".xyz", xyz_frame(snapshot));
        break;
      case ExportFormat::lammps_data:
        write(name + ".data", lammps_data(snapshot));
        break;
      case ExportFormat::lammps_dump:
        append(all + ".spheres.dump", lammps_dump(snapshot));
        append(all + ".contacts.dump", lammps_contacts(snapshot));
        break;
      case ExportFormat::vtkhdf:
        dem::write_vtkhdf(place_of(name + ".vtkhdf"), snapshot);
        break;
      case ExportFormat::npz:
        write_arrays(name + ".npz", snapshot);
        break;
      case ExportFormat::csv:
        write_tables(name, snapshot);
        break;
    }
  }

  void add_series(const fs::path& file) {
    CsvReader reader(file);
    std::vector<NamedArray> columns;
    for (const std::string& title : reader.header())
      columns.push_back({title.substr(0, title.find('[')), {}, std::vector<double>()});
    const std::string name = file.stem().string();
    if (header_.empty()) {
      header_ = reader.header();
      table_ = "test";
      for (const std::string& title : header_) table_ += "," + title;
      table_ += '\n';
    } else if (format_ == ExportFormat::csv && header_ != reader.header()) {
      reader.refuse("", "has other columns than the series before; export them as npz");
    }
    for (std::vector<double> row; reader.next(row);) {
      table_ += name;
      for (std::size_t c = 0; c < row.size(); ++c) {
        std::get<0>(columns[c].values).push_back(row[c]);
        table_ += "," + csv_number(row[c]);
      }
      table_ += '\n';
    }
    for (NamedArray& column : columns) column.shape = {std::get<0>(column.values).size()};
    ++done_.series;
    if (format_ == ExportFormat::csv) return;
    write_npz(place_of(name + ".npz"), columns);
  }

  Exported finish() {
    for (const auto& [name, text] : appended_) write(name, text);
    if (!spheres_.empty()) write("spheres.pvd", dem::pvd(spheres_));
    if (!contacts_.empty()) write("contacts.pvd", dem::pvd(contacts_));
    if (format_ == ExportFormat::csv && done_.series > 0) write(kAllSeries, table_);
    return std::move(done_);
  }

 private:
  /// Of a file that is about to be written: what is refused before leaves no folder.
  fs::path place_of(const std::string& name) {
    make_output_folder(output_);
    done_.files.push_back(name);
    return output_ / name;
  }

  void write(const std::string& name, const std::string& text) { write_durably(place_of(name), text); }

  void append(const std::string& name, const std::string& text) {
    const auto at =
        std::find_if(appended_.begin(), appended_.end(), [&](const auto& file) { return file.first == name; });
    if (at == appended_.end())
      appended_.emplace_back(name, text);
    else
      at->second += text;
  }

  void write_arrays(const std::string& name, const dem::Snapshot& s) {
    const dem::Packing& p = s.packing;
    std::vector<double> x, v, branch, force, overlap;
    std::vector<std::int64_t> ids;
    const auto add = [](std::vector<double>& to, const Eigen::Vector3d& a) { to.insert(to.end(), a.begin(), a.end()); };
    for (std::size_t i = 0; i < p.size(); ++i) {
      add(x, s.position(i));
      add(v, s.velocity(i));
    }
    for (const dem::SnapshotContact& c : s.contacts) {
      ids.insert(ids.end(), {p.id[c.i], p.id[c.j]});
      add(branch, c.branch);
      add(force, c.force);
      overlap.push_back(c.overlap);
    }
    const std::size_t n = p.size(), m = s.contacts.size();
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> H = p.H;
    write_npz(place_of(name), {{"time", {}, std::vector<double>{s.time}},
                               {"cell", {3, 3}, std::vector<double>(H.data(), H.data() + 9)},
                               {"id", {n}, p.id},
                               {"x", {n, 3}, x},
                               {"v", {n, 3}, v},
                               {"r", {n}, p.radius},
                               {"contact_ids", {m, 2}, ids},
                               {"contact_branch", {m, 3}, branch},
                               {"contact_force", {m, 3}, force},
                               {"contact_overlap", {m}, overlap}});
  }

  void write_tables(const std::string& name, const dem::Snapshot& s) {
    dem::write_spheres(place_of(name + ".spheres.csv"), s.packing);
    std::string text = "id1,id2,branch_x[m],branch_y[m],branch_z[m],force_x[N],force_y[N],force_z[N],overlap[m]\n";
    for (const dem::SnapshotContact& c : s.contacts)
      text += fmt::format("{},{},{},{},{},{},{},{},{}\n", s.packing.id[c.i], s.packing.id[c.j], c.branch[0],
                          c.branch[1], c.branch[2], c.force[0], c.force[1], c.force[2], c.overlap);
    write(name + ".contacts.csv", text);
  }

  ExportFormat format_;
  fs::path output_;
  std::vector<std::pair<double, std::string>> spheres_, contacts_;  // of the PVD
  std::vector<std::pair<std::string, std::string>> appended_;       // files with all frames, as they grow
  std::vector<std::string> header_;                                 // of the series
  std::string table_;                                               // of all series
  Exported done_;
};

/// The series of a data set, or of a folder of grainlaw simulate; none: there are states to be written.
std::vector<fs::path> series_of(const fs::path& source) {
  std::vector<fs::path> files;
  if (!fs::is_directory(source)) return files;
  if (fs::exists(source / "dataset.json") || fs::exists(source / "dataset" / "dataset.json")) {
    const fs::path folder = dataset_folder(source);
    for (const DatasetTest& test : read_dataset(folder).tests) files.push_back(folder / (test.record.name + ".csv"));
    return files;
  }
  for (const char* name : {"series.csv", "loading.csv", "unloading.csv"}) {
    if (fs::exists(source / name)) files.push_back(source / name);
  }
  return files;
}

}  // namespace

Exported export_files(const fs::path& source, ExportFormat format, const fs::path& output, const RunControl& control) {
  if (!fs::exists(source))
    throw InvalidInput(fmt::format("{}: does not exist; give a state file, a folder of grainlaw simulate or a data set",
                                   source.string()));
  const bool tables = format == ExportFormat::npz || format == ExportFormat::csv;
  const std::vector<fs::path> series = tables ? series_of(source) : std::vector<fs::path>{};
  const std::vector<StateSource> states = series.empty() ? states_of(source) : std::vector<StateSource>{};
  const bool with_forces = tables || format == ExportFormat::vtp || format == ExportFormat::lammps_dump;
  for (const StateSource& state : states) {  // refused before a folder is made
    if (dem::read_state(state.file).contacts.friction > 0 && with_forces)
      throw InvalidInput(
          fmt::format("{}: was made with friction, whose forces are not in a state; give a format that tells the "
                      "spheres alone: xyz, lammps-data or vtkhdf",
                      state.file.string()));
  }
  std::error_code none_there;
  for (const fs::path& file : series) {
    if (format == ExportFormat::csv && fs::equivalent(file, output / kAllSeries, none_there))
      throw InvalidInput(fmt::format("{}: would be overwritten; give another folder with -o", file.string()));
  }
  Export exported(format, output);
  const auto look = [&] {
    if (control.stop.stop_requested()) throw Interrupted("interrupted; files that are written are whole");
  };
  for (const fs::path& file : series) {
    look();
    exported.add_series(file);
  }
  for (const StateSource& state : states) {
    look();
    exported.add_state(state, states.size() == 1);
  }
  return exported.finish();
}

}  // namespace grainlaw::chain
