#include "model/files/path_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "model/files/csv_table.hpp"
#include "model/files/one_line.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

constexpr double kMaxStrain = 100;
constexpr double kSameStrain = 1e-14;      // changes of every component up to this are rounding and have no direction
constexpr double kStraight = 2e-5;         // strain by which rows may lie off a segment: five digits
constexpr std::size_t kMostRows = 1000;    // of a segment that are kept to judge it by
constexpr double kShort = 0.005;           // strain of segments between which no path of tests turns again and again
constexpr double kSharp = 0.985;           // cosine of a turn by 10 degrees
constexpr std::size_t kTooManyTurns = 10;  // sharp ones between short segments

/// Where the six components stand in a row; shears may be absent.
std::array<std::optional<std::size_t>, 6> strain_columns(const CsvReader& reader) {
  std::array<std::optional<std::size_t>, 6> columns;
  for (std::size_t c = 0; c < 6; ++c) {
    const std::string title = fmt::format("strain_{}", kComponentName[c]);
    const auto& header = reader.header();
    const auto at = std::find(header.begin(), header.end(), title);
    if (at != header.end()) {
      columns[c] = static_cast<std::size_t>(at - header.begin());
    } else if (c < 3) {
      reader.refuse(title, "is missing; give strain_xx, strain_yy and strain_zz, tension positive");
    }
  }
  return columns;
}

Eigen::Matrix3d strain_of(const CsvReader& reader, const std::array<std::optional<std::size_t>, 6>& columns,
                          const std::vector<double>& values) {
  Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < 6; ++c) {
    if (!columns[c]) continue;
    const double value = values[*columns[c]];
    const std::string& title = reader.header()[*columns[c]];
    if (std::isnan(value)) reader.refuse(title, "is empty; a path needs a number in every row");
    if (std::abs(value) > kMaxStrain)
      reader.refuse(title, fmt::format("{} is no strain; give logarithmic strain, not per cent", value));
    const auto [i, j] = kComponentIndex[c];
    strain(i, j) = strain(j, i) = value;
  }
  return strain;
}

/// The step as a segment whose path parameter is the length of the strain, with the extent that is better conditioned.
PathSegment segment_of(const Eigen::Matrix3d& step) {
  const double shear = deviatoric_norm(step), volume = std::abs(step.trace());
  PathSegment segment;
  segment.mode = Mode::tensor;
  segment.direction.tensor = step / step.norm();
  segment.extent_kind = shear >= volume ? ExtentKind::eps_dev : ExtentKind::eps_vol;
  segment.extent = std::max(shear, volume);
  return segment;
}

/// Whether the straight line from `corner` to `end` passes `rows` in their order.
bool is_straight(const Eigen::Matrix3d& corner, const std::vector<Eigen::Matrix3d>& rows, const Eigen::Matrix3d& end) {
  const double length = (end - corner).norm();
  const Eigen::Matrix3d n = length > 0 ? Eigen::Matrix3d((end - corner) / length) : Eigen::Matrix3d::Zero();
  double passed = 0;
  return std::ranges::all_of(rows, [&](const Eigen::Matrix3d& row) {
    const double along = (row - corner).cwiseProduct(n).sum(), off = (row - corner - along * n).norm();
    if (off > kStraight || along < passed - kStraight || along > length + kStraight) return false;
    passed = std::max(passed, along);
    return true;
  });
}

/// A measured strain history as straight segments that pass its rows.
std::vector<PathSegment> segments_from_csv(const std::filesystem::path& file, double nu) {
  CsvReader reader(file);
  const auto columns = strain_columns(reader);
  std::vector<PathSegment> segments;
  std::vector<double> values;
  std::optional<Eigen::Matrix3d> first;
  Eigen::Matrix3d corner = Eigen::Matrix3d::Zero(), before = corner;  // start of the last segment; the row before
  std::vector<Eigen::Matrix3d> rows;                                  // since the corner
  const auto end_segment = [&] {
    if ((before - corner).cwiseAbs().maxCoeff() <= kSameStrain) return;
    if (segments.size() == kMaxSegments)
      reader.refuse("", fmt::format("more than {} changes of direction; smooth or thin the rows", kMaxSegments));
    segments.push_back(segment_of(before - corner));
  };
  while (reader.next(values)) {
    const Eigen::Matrix3d strain = strain_of(reader, columns, values);
    if (!first) {
      first = corner = before = strain;
      continue;
    }
    if ((strain - before).cwiseAbs().maxCoeff() <= kSameStrain) continue;
    if (const double here = nu * std::exp(-(strain - *first).trace()); !(here <= kMaxVolumeFraction)) {
      reader.refuse("strain_xx", fmt::format("the strain leads to a volume fraction of {:.4g}, beyond {}", here,
                                             kMaxVolumeFraction));
    }
    if (!is_straight(corner, rows, strain)) {
      end_segment();
      corner = before;
      rows.clear();
    }
    if (rows.size() == kMostRows) {  // every second one will do
      for (std::size_t i = 0; i < kMostRows / 2; ++i) rows[i] = rows[2 * i + 1];
      rows.resize(kMostRows / 2);
    }
    rows.push_back(strain);
    before = strain;
  }
  end_segment();
  if (segments.empty()) reader.refuse("", "the strain never changes; give at least two different rows");
  return segments;
}

/// What is to be said of a measured history that looks like noise: laws take each of its turns for one of the material.
std::vector<std::string> warnings_of(const std::vector<PathSegment>& segments) {
  std::size_t turns = 0;
  for (std::size_t i = 1; i < segments.size(); ++i) {
    const PathSegment &a = segments[i - 1], &b = segments[i];
    turns +=
        a.direction.tensor.cwiseProduct(b.direction.tensor).sum() < kSharp && std::max(a.extent, b.extent) < kShort;
  }
  if (turns < kTooManyTurns || turns < segments.size() / 2) return {};
  return {fmt::format(
      "strain_csv turns by more than 10 degrees {} times in {} segments, after strains below {}: if that is noise of a "
      "measurement, smooth the rows; the law takes each turn for one of the material, and s and F come out too low",
      turns, segments.size(), kShort)};
}

/// The path of `document`, its segments written out or measured.
Path path_of(const Json& document, const std::filesystem::path& folder, const std::string& name) {
  const bool measured = document.contains("strain_csv");
  if (measured == document.contains("segments")) {
    throw InvalidInput(measured ? fmt::format("{}: has segments and strain_csv; give one of them", name)
                                : fmt::format("{}: misses the key 'segments'; give them, or strain_csv", name));
  }
  if (!measured) return path_from_json(document, name, "", false);
  Path path;
  path.nu = document["initial"]["nu"].get<double>();
  path.branch = branch_from_json(document["initial"]);
  path.segments = segments_from_csv(folder / document["strain_csv"].get<std::string>(), path.nu);
  return path;
}

}  // namespace

PathFile path_from_document(const Json& document, const std::filesystem::path& folder, const std::string& name) {
  check_schema(document, Schema::path, name);
  PathFile result;
  result.path = path_of(document, folder, name);
  if (document.contains("strain_csv")) result.warnings = warnings_of(result.path.segments);
  if (document.contains("seeds")) result.seeds = document["seeds"].get<std::vector<std::uint64_t>>();
  if (document.contains("rows")) result.rows = document["rows"].get<int>();
  return result;
}

PathFile read_path(const std::filesystem::path& file) {
  return path_from_document(read_json(file, JsonSource::user), file.parent_path(), one_line(file.string(), 200));
}

}  // namespace grainlaw
