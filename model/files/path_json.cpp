#include "model/files/path_json.hpp"

#include <fmt/format.h>

#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

Mode mode_from(const Json& object) { return value_of<Mode>(object["mode"].get<std::string>(), "mode"); }

Eigen::Matrix3d matrix_from(const Json& rows) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      m(i, j) = rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)).get<double>();
  }
  return m;
}

OrderedJson matrix_to_json(const Eigen::Matrix3d& m) {
  OrderedJson rows = OrderedJson::array();
  for (int i = 0; i < 3; ++i) {
    OrderedJson row = OrderedJson::array();
    // + 0.0 turns a negative zero of a reversed direction into zero
    for (int j = 0; j < 3; ++j) row.push_back(m(i, j) + 0.0);
    rows.push_back(row);
  }
  return rows;
}

/// mode, rate_tensor or velocity_gradient, whichever is there.
void read_direction(const Json& object, const std::string& where, bool both, PathSegment& segment) {
  const bool has_mode = object.contains("mode");
  const char* tensor = object.contains("rate_tensor") ? "rate_tensor" : "velocity_gradient";
  const bool has_tensor = object.contains(tensor);
  if (!has_mode && !has_tensor)
    throw InvalidInput(fmt::format("{}: misses its direction; give mode, rate_tensor or velocity_gradient", where));
  if (object.contains("rate_tensor") && object.contains("velocity_gradient"))
    throw InvalidInput(fmt::format("{}: has rate_tensor and velocity_gradient; give one of them", where));
  if (has_mode && has_tensor && !both)
    throw InvalidInput(fmt::format("{}: has mode and {}; give one of them", where, tensor));
  if (!has_tensor) {
    segment.mode = mode_from(object);
    segment.direction = direction_of(segment.mode, object.value("axes", "xyz"), object.value("reverse", false));
    return;
  }
  for (const char* key : {"axes", "reverse"}) {
    if (object.contains(key))
      throw InvalidInput(fmt::format("{}.{}: belongs to a mode; write it into {}", where, key, tensor));
  }
  segment.mode = has_mode ? mode_from(object) : Mode::tensor;
  const Eigen::Matrix3d L = matrix_from(object[tensor]);
  const Eigen::Matrix3d D = (L + L.transpose()) / 2;
  if (object.contains("rate_tensor") && (L - L.transpose()).norm() != 0)
    throw InvalidInput(
        fmt::format("{}.rate_tensor: is not symmetric; a direction with spin is a velocity_gradient", where));
  if (D.norm() == 0 && !object.contains("free"))
    throw InvalidInput(fmt::format("{}.{}: is zero{}; give a direction", where, tensor,
                                   L.norm() == 0 ? "" : " but for its spin, which does not deform"));
  segment.direction.tensor = D;
  segment.spin = (L - L.transpose()) / 2;
}

std::vector<Condition> conditions_from(const Json& free) {
  std::vector<Condition> conditions;
  for (const auto& item : free.items()) {
    Condition condition;
    for (int i = 0; i < 6; ++i) {
      if (item.key() == kComponentName.at(static_cast<std::size_t>(i))) condition.free = i;
    }
    condition.quantity = value_of<Condition::Quantity>(item.value()["quantity"].get<std::string>(), "quantity");
    condition.rate = item.value().value("rate", 0.0);
    conditions.push_back(condition);
  }
  return conditions;
}

OrderedJson conditions_to_json(const std::vector<Condition>& conditions) {
  OrderedJson object = OrderedJson::object();
  for (const Condition& condition : conditions)
    object[free_name(condition)] = {{"quantity", to_string(condition.quantity)}, {"rate", condition.rate}};
  return object;
}

void read_extent(const Json& object, PathSegment& segment) {
  const auto extent = object["extent"].items().begin();
  segment.extent_kind = value_of<ExtentKind>(extent.key(), "extent");
  segment.extent = extent.value().get<double>();
}

/// `count` times out by `amplitude`, back by twice that and out again to the middle, or one-sided just out and back;
/// two cycles share the leg between them.
void append_cycles(PathSegment leg, const Json& cycles, std::vector<PathSegment>& segments) {
  const double amplitude = cycles["amplitude"].get<double>();
  const bool one_sided = cycles.value("one_sided", false);
  leg.extent_kind = shears(leg.direction) ? ExtentKind::eps_dev : ExtentKind::eps_vol;
  PathSegment back = leg;
  back.direction.tensor = -leg.direction.tensor;
  back.spin = -leg.spin;
  const auto add = [&](PathSegment segment, double extent) {
    segment.extent = extent;
    segments.push_back(std::move(segment));
  };
  const int count = cycles["count"].get<int>();
  for (int i = 0; i < count; ++i) {
    add(leg, one_sided || i == 0 ? amplitude : 2 * amplitude);
    add(back, one_sided ? amplitude : 2 * amplitude);
  }
  if (!one_sided) add(leg, amplitude);
}

/// One segment, or the legs of its cycles.
void append_segment(const Json& object, const std::string& where, bool both, std::vector<PathSegment>& segments) {
  PathSegment segment;
  read_direction(object, where, both, segment);
  if (object.contains("free")) segment.conditions = conditions_from(object["free"]);
  const bool has_cycles = object.contains("cycles");
  if (has_cycles && object.contains("extent"))
    throw InvalidInput(fmt::format("{}: has extent and cycles; give one of them", where));
  if (!has_cycles && !object.contains("extent"))
    throw InvalidInput(
        fmt::format("{}: misses the key 'extent'; give one of {}, or cycles", where, list_of_names<ExtentKind>()));
  if (has_cycles && !segment.conditions.empty())
    throw InvalidInput(
        fmt::format("{}.cycles: are of strain; give segments with an extent where rates are free", where));
  if (has_cycles) {
    append_cycles(segment, object["cycles"], segments);
  } else {
    read_extent(object, segment);
    segments.push_back(segment);
  }
}

}  // namespace

Branch branch_from_json(const Json& object) {
  return value_of<Branch>(object.value("branch", to_string(Branch::unloading)), "branch");
}

std::vector<PathSegment> segments_from_json(const Json& segments, const std::string& name, const std::string& place,
                                            bool both) {
  std::vector<PathSegment> result;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    append_segment(segments[i], fmt::format("{}: {}segments[{}]", name, place, i), both, result);
    if (result.size() > kMaxSegments) {
      throw InvalidInput(
          fmt::format("{}: {}segments[{}].cycles: with these the path has {} straight pieces, more than {}; "
                      "give fewer cycles",
                      name, place, i, result.size(), kMaxSegments));
    }
  }
  return result;
}

Path path_from_json(const Json& document, const std::string& name, const std::string& place, bool both) {
  Path path;
  path.nu = document.at("initial").at("nu").get<double>();
  path.branch = branch_from_json(document["initial"]);
  path.segments = segments_from_json(document.at("segments"), name, place, both);
  try {
    check(path);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}{}", name, place, error.what()));
  }
  return path;
}

OrderedJson segments_to_json(const std::vector<PathSegment>& segments) {
  OrderedJson array = OrderedJson::array();
  for (const PathSegment& segment : segments) {
    OrderedJson object = OrderedJson::object();
    if (segment.mode != Mode::tensor) object["mode"] = to_string(segment.mode);
    if (segment.spin.isZero(0))
      object["rate_tensor"] = matrix_to_json(segment.direction.tensor);
    else
      object["velocity_gradient"] = matrix_to_json(segment.direction.tensor + segment.spin);
    if (!segment.conditions.empty()) object["free"] = conditions_to_json(segment.conditions);
    object["extent"] = {{to_string(segment.extent_kind), segment.extent}};
    array.push_back(object);
  }
  return array;
}

OrderedJson path_to_json(const Path& path) {
  OrderedJson object = OrderedJson::object();
  object["initial"] = {{"nu", path.nu}, {"branch", to_string(path.branch)}};
  object["segments"] = segments_to_json(path.segments);
  return object;
}

}  // namespace grainlaw
