#include "app/files/path_file.hpp"

#include "app/files/path_json.hpp"
#include "app/files/schema.hpp"
#include "app/one_line.hpp"

namespace grainlaw::app {

PathFile read_path(const std::filesystem::path& file) {
  const Json document = read_json(file, JsonSource::user);
  const std::string name = one_line(file.string(), 200);
  check_schema(document, Schema::path, name);
  PathFile result;
  result.path = path_from_json(document, name, "", false);
  if (document.contains("seeds")) result.seeds = document["seeds"].get<std::vector<std::uint64_t>>();
  if (document.contains("rows")) result.rows = document["rows"].get<int>();
  return result;
}

}  // namespace grainlaw::app
