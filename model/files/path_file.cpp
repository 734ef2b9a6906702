#include "model/files/path_file.hpp"

#include <fmt/format.h>

#include "model/files/path_csv.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

/// The path of `document`, its segments written out or measured.
Path path_of(const Json& document, const std::filesystem::path& file, const std::string& name) {
  const bool measured = document.contains("strain_csv");
  if (measured == document.contains("segments")) {
    throw InvalidInput(measured ? fmt::format("{}: has segments and strain_csv; give one of them", name)
                                : fmt::format("{}: misses the key 'segments'; give them, or strain_csv", name));
  }
  if (!measured) return path_from_json(document, name, "", false);
  Path path;
  path.nu = document["initial"]["nu"].get<double>();
  path.branch = branch_from_json(document["initial"]);
  path.segments = segments_from_csv(file.parent_path() / document["strain_csv"].get<std::string>(), path.nu);
  return path;
}

}  // namespace

PathFile read_path(const std::filesystem::path& file) {
  const Json document = read_json(file, JsonSource::user);
  const std::string name = one_line(file.string(), 200);
  check_schema(document, Schema::path, name);
  PathFile result;
  result.path = path_of(document, file, name);
  if (document.contains("seeds")) result.seeds = document["seeds"].get<std::vector<std::uint64_t>>();
  if (document.contains("rows")) result.rows = document["rows"].get<int>();
  return result;
}

}  // namespace grainlaw
