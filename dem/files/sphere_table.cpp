#include "dem/files/sphere_table.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <unordered_map>

#include "dem/engine/neighbour_list.hpp"
#include "dem/files/text_file.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr std::size_t kMaxRows = 100'000'000;

enum Column : std::size_t { id, x, y, z, r, vx, vy, vz, kColumns };
constexpr std::array<std::string_view, kColumns> kName{"id", "x", "y", "z", "r", "vx", "vy", "vz"};
constexpr std::array<std::string_view, kColumns> kUnit{"", "m", "m", "m", "m", "m/s", "m/s", "m/s"};

/// Calls visit(field number, field) for each field of the line.
template <class Visit>
void split(std::string_view line, const Visit& visit) {
  for (std::size_t field = 0;; ++field) {
    const std::size_t comma = line.find(',');
    visit(field, trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

/// Which column each field of the file holds.
std::vector<Column> read_header(const TextFile& lines) {
  std::string_view line = lines.line();
  if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);  // byte order mark of spreadsheets
  std::vector<Column> order;
  std::array<bool, kColumns> seen{};
  split(line, [&](std::size_t, std::string_view field) {
    const std::size_t bracket = field.find('[');
    const std::string_view name = trimmed(field.substr(0, bracket));
    const auto known = std::find(kName.begin(), kName.end(), name);
    if (known == kName.end()) {
      throw lines.refusal(in_quotes(name),
                          "is no column of a sphere table; give a header with id,x,y,z,r and, if "
                          "known, vx,vy,vz, separated by commas");
    }
    const auto column = static_cast<Column>(known - kName.begin());
    if (bracket != std::string_view::npos && field.substr(bracket) != fmt::format("[{}]", kUnit[column])) {
      throw lines.refusal(
          name, fmt::format("unit {} is not [{}]; convert it", in_quotes(field.substr(bracket)), kUnit[column]));
    }
    if (seen[column]) throw lines.refusal(name, "appears twice");
    seen[column] = true;
    order.push_back(column);
  });
  for (std::size_t c = 0; c < vx; ++c) {
    if (!seen[c]) throw lines.refusal(kName[c], "is missing");
  }
  if (seen[vx] != seen[vy] || seen[vx] != seen[vz])
    throw lines.refusal("vx, vy, vz", "give all three velocities or none");
  return order;
}

struct Sphere {
  std::int64_t name = 0;
  std::array<double, kColumns> value{};  // SI; [id] unused
};

Sphere read_row(const TextFile& lines, const std::vector<Column>& order) {
  const std::string_view line = lines.line();
  Sphere sphere;
  const auto fields = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
  if (fields != order.size()) {
    throw lines.refusal(
        "", fmt::format("has {} fields, the header has {} (is a decimal comma in use?)", fields, order.size()));
  }
  split(line, [&](std::size_t field, std::string_view text) {
    const Column column = order[field];
    if (column == id) {
      const auto name = number_of<std::int64_t>(text);
      if (!name) throw lines.refusal("id", in_quotes(text) + " is no integer");
      sphere.name = *name;
      return;
    }
    const auto value = decimal(text);
    if (!value) throw lines.refusal(kName[column], in_quotes(text) + " is no number (decimal point, no thousands)");
    if (!std::isfinite(*value)) throw lines.refusal(kName[column], in_quotes(text) + " is not finite");
    if (column == r && !(*value > 0)) throw lines.refusal("r", in_quotes(text) + " is not positive");
    sphere.value[column] = *value;
  });
  return sphere;
}

void check_cell(const std::filesystem::path& file, const Eigen::Matrix3d& H) {
  if (!H.allFinite() || H(1, 0) != 0 || H(2, 0) != 0 || H(2, 1) != 0 || !(H.diagonal().minCoeff() > 0)) {
    throw InvalidInput(
        fmt::format("{}: its cell must be upper triangular with a positive, finite diagonal", file.string()));
  }
}

}  // namespace

State read_spheres(const std::filesystem::path& file, const Eigen::Matrix3d& cell, const Material& material) {
  check_cell(file, cell);
  TextFile lines(file, "give a CSV file of spheres");
  if (!lines.next()) throw lines.refusal(1, "", "the file is empty; give a header id,x,y,z,r and one line per sphere");
  const std::vector<Column> order = read_header(lines);

  State state;
  state.material = material;
  Packing& p = state.packing;
  p.H = cell;
  const Eigen::Matrix3d inverse = cell.inverse();
  std::unordered_map<std::int64_t, std::size_t> row_of;
  while (lines.next()) {
    if (trimmed(lines.line()).empty()) {
      while (lines.next()) {
        if (!trimmed(lines.line()).empty()) throw lines.refusal("", "follows an empty line; remove that");
      }
      break;
    }
    const Sphere sphere = read_row(lines, order);
    const auto [earlier, fresh] = row_of.emplace(sphere.name, lines.number());
    if (!fresh) throw lines.refusal("id", fmt::format("{} is already in line {}", sphere.name, earlier->second));
    if (p.size() == kMaxRows) throw lines.refusal("", "more than 1e8 spheres are not supported");
    const auto& value = sphere.value;
    const Eigen::Vector3d s = inverse * Eigen::Vector3d(value[x], value[y], value[z]);
    if (!(s.lpNorm<Eigen::Infinity>() <= kMaxCellsAway)) {
      throw lines.refusal("x, y, z", "the position lies more than 1000 cells away; are both in metres?");
    }
    p.id.push_back(sphere.name);
    p.radius.push_back(value[r]);
    p.sx.push_back(s[0]);
    p.sy.push_back(s[1]);
    p.sz.push_back(s[2]);
    p.vx.push_back(value[vx]);
    p.vy.push_back(value[vy]);
    p.vz.push_back(value[vz]);
  }
  if (p.size() == 0) throw lines.refusal("", "no spheres follow the header");
  p.mass.resize(p.size());
  try {
    check_sizes(p);
    set_masses(p, material);
    check(p);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", file.string(), error.what()));
  }
  return state;
}

void write_spheres(const std::filesystem::path& file, const Packing& packing) {
  check(packing);
  Packing p = packing;
  wrap(p);
  std::string out;
  for (std::size_t c = 0; c < kColumns; ++c) {
    out += c ? "," : "";
    out += kName[c];
    if (!kUnit[c].empty()) out += fmt::format("[{}]", kUnit[c]);
  }
  out += '\n';
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d position = p.H * Eigen::Vector3d(p.sx[i], p.sy[i], p.sz[i]);
    fmt::format_to(std::back_inserter(out), "{},{},{},{},{},{},{},{}\n", p.id[i], position[0], position[1], position[2],
                   p.radius[i], p.vx[i], p.vy[i], p.vz[i]);
  }
  write_durably(file, out);
}

}  // namespace grainlaw::dem
