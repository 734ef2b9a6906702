#include "app/files/path_json.hpp"

#include <fmt/format.h>

#include "model/error.hpp"

namespace grainlaw::app {
namespace {

Mode mode_from(const std::string& text) {
  for (const Mode mode : {Mode::ISO, Mode::UNI, Mode::D2, Mode::D3}) {
    if (to_string(mode) == text) return mode;
  }
  throw InvalidInput(fmt::format("mode: '{}' is none of ISO, UNI, D2, D3", text));
}

StrainRate rate_from(const Json& rows) {
  StrainRate rate;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      rate.tensor(i, j) = rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)).get<double>();
  }
  return rate;
}

PathSegment segment_from(const Json& object, const std::string& where, bool both) {
  PathSegment segment;
  const bool has_mode = object.contains("mode"), has_tensor = object.contains("rate_tensor");
  if (!has_mode && !has_tensor)
    throw InvalidInput(fmt::format("{}: misses its direction; give mode or rate_tensor", where));
  if (has_mode && has_tensor && !both)
    throw InvalidInput(fmt::format("{}: has mode and rate_tensor; give one of them", where));
  if (has_tensor) {
    for (const char* key : {"axes", "reverse"}) {
      if (object.contains(key))
        throw InvalidInput(fmt::format("{}.{}: belongs to a mode; write it into rate_tensor", where, key));
    }
    segment.mode = has_mode ? mode_from(object["mode"]) : Mode::tensor;
    segment.direction = rate_from(object["rate_tensor"]);
    const Eigen::Matrix3d& D = segment.direction.tensor;
    if ((D - D.transpose()).norm() != 0) throw InvalidInput(fmt::format("{}.rate_tensor: is not symmetric", where));
    if (D.norm() == 0) throw InvalidInput(fmt::format("{}.rate_tensor: is zero; give a direction", where));
  } else {
    segment.mode = mode_from(object["mode"]);
    segment.direction = direction_of(segment.mode, object.value("axes", "xyz"), object.value("reverse", false));
  }
  const auto extent = object["extent"].items().begin();
  segment.extent_kind = extent.key() == "eps_dev"   ? ExtentKind::eps_dev
                        : extent.key() == "eps_vol" ? ExtentKind::eps_vol
                                                    : ExtentKind::target_nu;
  segment.extent = extent.value().get<double>();
  return segment;
}

}  // namespace

Branch branch_from_json(const Json& object) {
  return object.value("branch", "unloading") == "loading" ? Branch::loading : Branch::unloading;
}

std::vector<PathSegment> segments_from_json(const Json& segments, const std::string& name, const std::string& place,
                                            bool both) {
  std::vector<PathSegment> result;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    result.push_back(segment_from(segments[i], fmt::format("{}: {}segments[{}]", name, place, i), both));
  }
  return result;
}

Path path_from_json(const Json& document, const std::string& name, const std::string& place, bool both) {
  Path path;
  path.nu = document["initial"]["nu"].get<double>();
  path.branch = branch_from_json(document["initial"]);
  path.segments = segments_from_json(document["segments"], name, place, both);
  try {
    resolve(path);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}{}", name, place, error.what()));
  }
  return path;
}

OrderedJson segments_to_json(const std::vector<PathSegment>& segments) {
  OrderedJson array = OrderedJson::array();
  for (const PathSegment& segment : segments) {
    OrderedJson object;
    if (segment.mode != Mode::tensor) object["mode"] = to_string(segment.mode);
    OrderedJson rows = OrderedJson::array();
    for (int i = 0; i < 3; ++i) {
      OrderedJson row = OrderedJson::array();
      // + 0.0 turns a negative zero of a reversed direction into zero
      for (int j = 0; j < 3; ++j) row.push_back(segment.direction.tensor(i, j) + 0.0);
      rows.push_back(row);
    }
    object["rate_tensor"] = rows;
    const char* kind = segment.extent_kind == ExtentKind::eps_dev   ? "eps_dev"
                       : segment.extent_kind == ExtentKind::eps_vol ? "eps_vol"
                                                                    : "target_nu";
    object["extent"] = {{kind, segment.extent}};
    array.push_back(object);
  }
  return array;
}

OrderedJson path_to_json(const Path& path) {
  OrderedJson object;
  object["initial"] = {{"nu", path.nu}, {"branch", to_string(path.branch)}};
  object["segments"] = segments_to_json(path.segments);
  return object;
}

}  // namespace grainlaw::app
