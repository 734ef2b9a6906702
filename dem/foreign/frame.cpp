#include "dem/foreign/frame.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "dem/engine/neighbour_list.hpp"

namespace grainlaw::dem {
namespace {

constexpr std::size_t kNone = std::string::npos;

std::size_t place_of(const NumberTable& table, const std::string& title) {
  const auto at = std::find(table.columns.begin(), table.columns.end(), title);
  return at == table.columns.end() ? kNone : static_cast<std::size_t>(at - table.columns.begin());
}

/// Reads columns of a table by their titles.
class Columns {
 public:
  explicit Columns(const ForeignFrame& frame) : frame_(frame), table_(frame.table) {}

  /// The column of the title that is given, which must be there; else the first of the usual ones; kNone without.
  std::size_t find(const std::string& given, std::initializer_list<const char*> usual) const {
    if (!given.empty()) return need(given);
    for (const char* title : usual) {
      if (const std::size_t at = place_of(table_, title); at != kNone) return at;
    }
    return kNone;
  }

  std::size_t need(const std::string& title) const {
    const std::size_t at = place_of(table_, title);
    if (at == kNone)
      throw frame_.refusal(
          fmt::format("has no column {}, but {}; name the columns in the mapping", in_quotes(title), titles()));
    return at;
  }

  std::string titles() const { return fmt::format("{}", fmt::join(table_.columns, ", ")).substr(0, 300); }

  double number(std::size_t row, std::size_t column) const {
    const double value = table_.values[row * table_.columns.size() + column];
    if (!std::isfinite(value)) throw refusal(row, column, "is no finite number");
    return value;
  }

  std::int64_t id(std::size_t row, std::size_t column) const {
    const double value = number(row, column);
    if (value != std::floor(value) || std::abs(value) > 0x1p53) throw refusal(row, column, "is no integer");
    return static_cast<std::int64_t>(value);
  }

  InvalidInput refusal(std::size_t row, std::size_t column, const std::string& why) const {
    return frame_.refusal(why, row + 1, column == kNone ? "" : table_.columns[column]);
  }

 private:
  const ForeignFrame& frame_;
  const NumberTable& table_;
};

}  // namespace

Frames::Frames(const ParticleRequest& request)
    : request_(request),
      spheres_(request.format, request.files),
      contacts_(request.contacts ? request.contacts->format : request.format,
                request.contacts ? request.contacts->files : std::vector<std::filesystem::path>{}) {}

bool Frames::next(Frame& frame) {
  ForeignFrame from;
  if (!spheres_.next(from)) {
    ForeignFrame more;
    if (contacts_.next(more))
      throw more.refusal(fmt::format("follows the {} frames of the spheres; give as many", count_));
    for (const auto& [given, what] : {std::pair{request_.times.size(), "times"},
                                      {request_.cells.size() > 1 ? request_.cells.size() : 0, "cells"}}) {
      if (given > count_)
        throw InvalidInput(
            fmt::format("{}: {}: {} for {} frames; give one for each", request_.where, what, given, count_));
    }
    return false;
  }
  frame = {};
  frame.time = time_of(from);
  take_spheres(from, frame);
  if (request_.contacts) {
    ForeignFrame contacts;
    if (!contacts_.next(contacts)) throw from.refusal("has no frame of contacts; give as many as of spheres");
    if (contacts.step == contacts.step && from.step == from.step && contacts.step != from.step)
      throw contacts.refusal(fmt::format("its spheres are those of step {}; dump both at the same steps", from.step));
    take_contacts(contacts, frame);
    contacts.table.values = {};
    frame.contacts_source = std::move(contacts);
  }
  from.table.values = {};
  frame.source = std::move(from);
  ++count_;
  return true;
}

double Frames::time_of(const ForeignFrame& frame) const {
  if (!request_.times.empty()) {
    if (count_ >= request_.times.size())
      throw frame.refusal(fmt::format("is frame {}, but there are {} times", count_ + 1, request_.times.size()));
    return request_.times[count_];
  }
  return std::isnan(frame.time) ? frame.step * request_.time_step : frame.time * request_.time;
}

Eigen::Matrix3d Frames::cell_of(const ForeignFrame& frame) const {
  if (!request_.cells.empty()) {
    if (request_.cells.size() > 1 && count_ >= request_.cells.size())
      throw frame.refusal(fmt::format("is frame {}, but there are {} cells", count_ + 1, request_.cells.size()));
    return request_.cells[request_.cells.size() > 1 ? count_ : 0];
  }
  if (!frame.H) throw frame.refusal("has no cell; give 'cell' or 'cells' in the mapping");
  const Eigen::Matrix3d H = request_.length * *frame.H;
  const double small = 1e-12 * H.cwiseAbs().maxCoeff();
  if (!H.allFinite() || std::abs(H(1, 0)) > small || std::abs(H(2, 0)) > small || std::abs(H(2, 1)) > small ||
      !(H.diagonal().minCoeff() > small))
    throw frame.refusal(
        "its cell must have its first edge along x, the second in the xy plane, the third towards z; turn cell and "
        "spheres");
  return H.triangularView<Eigen::Upper>();
}

void Frames::take_spheres(const ForeignFrame& from, Frame& to) const {
  const Columns columns(from);
  const SphereColumns& names = request_.columns;
  const std::size_t rows = from.table.rows();
  if (rows == 0) throw from.refusal("has no spheres");
  const std::size_t id = columns.find(names.id, {"id", "ID"});
  const std::size_t diameter = names.r.empty() ? columns.find(names.diameter, {"diameter"}) : kNone;
  const std::size_t r =
      names.diameter.empty() ? columns.find(names.r, {"radius", "r", "Radius", "radii", "rad"}) : kNone;
  if (r == kNone && diameter == kNone)
    throw from.refusal(
        fmt::format("has no radii among {}; write radius or diameter, or name the column 'r'", columns.titles()));
  const std::array place{columns.find(names.x, {"x", "xu", "pos_x", "Points_x"}),
                         columns.find(names.y, {"y", "yu", "pos_y", "Points_y"}),
                         columns.find(names.z, {"z", "zu", "pos_z", "Points_z"})};
  const std::array scaled{columns.find("", {"xs", "xsu"}), columns.find("", {"ys", "ysu"}),
                          columns.find("", {"zs", "zsu"})};
  const bool in_cell = place[0] == kNone;
  for (std::size_t a = 0; a < 3; ++a) {
    if ((in_cell ? scaled : place)[a] == kNone)
      throw from.refusal(
          fmt::format("has no positions {} among {}; name the columns x, y, z", "xyz"[a], columns.titles()));
  }
  const std::array velocity{columns.find(names.vx, {"vx", "velocity_x", "velo_x", "v_x"}),
                            columns.find(names.vy, {"vy", "velocity_y", "velo_y", "v_y"}),
                            columns.find(names.vz, {"vz", "velocity_z", "velo_z", "v_z"})};
  to.has_velocities = velocity[0] != kNone && velocity[1] != kNone && velocity[2] != kNone;

  std::vector<std::int64_t> ids(rows);
  for (std::size_t row = 0; row < rows; ++row)
    ids[row] = id == kNone ? static_cast<std::int64_t>(row) : columns.id(row, id);
  std::vector<std::size_t> order(rows);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });

  Packing& p = to.packing;
  resize(p, rows);
  p.H = cell_of(from);
  const Eigen::Matrix3d inverse = p.H.inverse();
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t row = order[i];
    if (i > 0 && ids[row] == ids[order[i - 1]])
      throw columns.refusal(row, id, fmt::format("{} is doubled; each sphere must have an id of its own", ids[row]));
    const auto numbers = [&](const std::array<std::size_t, 3>& c) {
      return Eigen::Vector3d(columns.number(row, c[0]), columns.number(row, c[1]), columns.number(row, c[2]));
    };
    p.id[i] = ids[row];
    p.radius[i] = request_.length * (r != kNone ? columns.number(row, r) : columns.number(row, diameter) / 2);
    if (!(p.radius[i] > 0)) throw columns.refusal(row, r != kNone ? r : diameter, "is not positive");
    const Eigen::Vector3d s =
        in_cell ? numbers(scaled) : Eigen::Vector3d(inverse * (request_.length * (numbers(place) - from.origin)));
    if (!(s.lpNorm<Eigen::Infinity>() <= kMaxCellsAway))
      throw columns.refusal(row, (in_cell ? scaled : place)[0],
                            "lies more than 1000 cells away; are both in one unit?");
    p.sx[i] = s[0], p.sy[i] = s[1], p.sz[i] = s[2];
    if (to.has_velocities) {
      const Eigen::Vector3d v = request_.length / request_.time * numbers(velocity);
      p.vx[i] = v[0], p.vy[i] = v[1], p.vz[i] = v[2];
    }
  }
  try {
    check_sizes(p);
  } catch (const InvalidInput& error) {
    throw from.refusal(error.what());
  }
  wrap(p);
  if (!std::isnan(request_.density)) set_masses(p, Material{.density = request_.density});
}

void Frames::take_contacts(const ForeignFrame& from, Frame& to) const {
  const Columns columns(from);
  const ContactRequest& names = *request_.contacts;
  const auto three = [&](const std::array<std::string, 3>& titles) {
    return std::array{columns.need(titles[0]), columns.need(titles[1]), columns.need(titles[2])};
  };
  const std::size_t first = columns.need(names.first), second = columns.need(names.second);
  const std::array force = three(names.force);
  const bool has_tangential = !names.tangential[0].empty(), has_branch = !names.branch[0].empty();
  const std::array tangential = has_tangential ? three(names.tangential) : force;
  const std::array branch = has_branch ? three(names.branch) : force;
  const std::vector<std::int64_t>& ids = to.packing.id;
  for (std::size_t row = 0; row < from.table.rows(); ++row) {
    const auto numbers = [&](const std::array<std::size_t, 3>& c) {
      return Eigen::Vector3d(columns.number(row, c[0]), columns.number(row, c[1]), columns.number(row, c[2]));
    };
    const auto sphere = [&](std::size_t column) {
      const std::int64_t name = columns.id(row, column);
      const auto at = std::lower_bound(ids.begin(), ids.end(), name);
      if (at == ids.end() || *at != name)
        throw columns.refusal(row, column, fmt::format("no sphere of the frame has the id {}", name));
      return static_cast<std::size_t>(at - ids.begin());
    };
    ListedContact contact{sphere(first), sphere(second), request_.force * numbers(force)};
    contact.line = from.table.first_line + row;
    if (has_tangential) contact.force += request_.force * numbers(tangential);
    if (names.on_second) contact.force = -contact.force;
    if (has_branch) contact.branch = request_.length * numbers(branch);
    to.contacts.push_back(contact);
  }
}

}  // namespace grainlaw::dem
