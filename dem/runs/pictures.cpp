#include "dem/runs/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem/files/state_file.hpp"
#include "dem/runs/preparation_folder.hpp"
#include "model/files/json_document.hpp"
#include "model/files/output.hpp"
#include "model/files/whole_number.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAxes[] = {"x", "y", "z"};

/// D2 alone, at the middle one of the densities at which the first packing shears so for the calibration.
const PlannedTest* shown_test(const std::vector<PlannedTest>& tests) {
  std::vector<const PlannedTest*> sheared;
  for (const PlannedTest& test : tests) {
    const auto& segments = test.path.segments;
    if (test.preparation.packing.seed == tests.front().preparation.packing.seed && test.role == Role::calibration &&
        segments.size() == 1 && segments.front().mode == Mode::D2)
      sheared.push_back(&test);
  }
  if (sheared.empty()) return nullptr;
  const auto middle = sheared.begin() + static_cast<std::ptrdiff_t>(sheared.size() / 2);
  std::nth_element(sheared.begin(), middle, sheared.end(),
                   [](const PlannedTest* a, const PlannedTest* b) { return a->path.nu < b->path.nu; });
  return *middle;
}

/// To three decimals: a thousandth of a radius is a tenth of a pixel.
template <class Rows>
void round_all(Rows& rows) {
  for (auto& row : rows) {
    for (double& value : row) value = std::round(1e3 * value) / 1e3;
  }
}

OrderedJson to_json(PackingPicture picture) {
  round_all(picture.circles);
  round_all(picture.chains);
  OrderedJson json = OrderedJson::object();
  for_each_field<PackingPicture>([&](const auto& field) { json[field.name] = picture.*field.access; });
  return json;
}

PackingPicture from_json(const Json& json) {
  PackingPicture picture;
  for_each_field<PackingPicture>([&](const auto& field) { json.at(field.name).get_to(picture.*field.access); });
  if (!(picture.width > 0 && picture.height > 0)) throw InvalidInput("width and height must be positive");
  for (const auto* rose : {&picture.count, &picture.force}) {
    if (rose->size() != std::size_t{kRoseBins} && !(picture.count.empty() && picture.force.empty()))
      throw InvalidInput(fmt::format("count and force need {} numbers each, or none", kRoseBins));
  }
  return picture;
}

}  // namespace

void write_pictures(const fs::path& folder, const std::vector<PlannedTest>& tests, const RunStore& store, int threads) {
  const PlannedTest* const test = shown_test(tests);
  const fs::path before =
      test ? store.folder(preparation_key(test->preparation)) / kept_file(test->path.branch, test->path.nu)
           : fs::path();
  const fs::path after = test ? store.folder(test_key(*test)) / "end.state" : fs::path();
  if (!test || !fs::exists(before) || !fs::exists(after)) {
    fs::remove(folder / kPicturesFile);
    return;
  }
  const PathSegment& shear = test->path.segments.front();
  Eigen::Index horizontal = 0, vertical = 0;
  shear.direction.tensor.diagonal().maxCoeff(&horizontal);
  shear.direction.tensor.diagonal().minCoeff(&vertical);
  const auto drawn = [&](const fs::path& file) {
    return to_json(picture_of(read_state(file), static_cast<int>(horizontal), static_cast<int>(vertical), threads));
  };
  write_json(folder / kPicturesFile, {{"format", "grainlaw pictures"},
                                      {"test", test->name},
                                      {"nu", test->path.nu},
                                      {"strain", shear.extent},
                                      {"particles", test->preparation.packing.particles},
                                      {"horizontal", kAxes[horizontal]},
                                      {"vertical", kAxes[vertical]},
                                      {"before", drawn(before)},
                                      {"after", drawn(after)}});
}

void adopt_pictures(const fs::path& from, const fs::path& to) {
  std::error_code absent;
  if (fs::equivalent(from, to, absent)) return;
  fs::remove(to / kPicturesFile);
  if (fs::exists(from / kPicturesFile)) copy_durably(from / kPicturesFile, to / kPicturesFile);
}

std::optional<ShearPictures> read_pictures(const fs::path& folder) {
  const fs::path file = folder / kPicturesFile;
  if (!fs::exists(file)) return std::nullopt;
  const Json json = read_json(file, JsonSource::own);
  try {
    ShearPictures pictures;
    json.at("test").get_to(pictures.test);
    json.at("nu").get_to(pictures.nu);
    json.at("strain").get_to(pictures.strain);
    pictures.particles = whole_number<std::int64_t>(json.at("particles"));
    json.at("horizontal").get_to(pictures.horizontal);
    json.at("vertical").get_to(pictures.vertical);
    pictures.note = json.value("note", "");
    pictures.before = from_json(json.at("before"));
    pictures.after = from_json(json.at("after"));
    return pictures;
  } catch (const Json::exception& error) {
    throw InvalidInput(fmt::format("{}: {}", file.string(), error.what()));
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", file.string(), error.what()));
  }
}

}  // namespace grainlaw::dem
