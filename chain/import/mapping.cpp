#include "chain/import/mapping.hpp"

#include <fmt/format.h>

#include <set>

#include "model/files/digest.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

/// What holds for all tests, under `key`, with what the test says instead; null where neither says anything.
Json merged(const Json& document, const Json& test, const char* key) {
  if (!test.contains(key)) return {};
  Json all = document.value(key, Json::object());
  all.merge_patch(test[key]);
  return all;
}

ColumnChoice column_from(const Json& json) {
  if (json.is_string()) return {.name = json, .unit = {}};
  if (json.is_number()) return {.name = "", .number = json, .unit = {}};
  ColumnChoice choice = column_from(json["column"]);
  if (json.contains("unit")) choice.unit = json["unit"].get<std::string>();
  return choice;
}

SeriesMapping series_from(const Json& json, const fs::path& folder) {
  SeriesMapping series;
  if (json.contains("file")) series.file = folder / json["file"].get<std::string>();
  if (json.contains("delimiter"))
    series.delimiter = value_of<Delimiter>(json["delimiter"].get<std::string>(), "delimiter");
  series.decimal = json.value("decimal", "point") == "comma" ? ',' : '.';
  series.skip = json.value("skip", std::size_t{0});
  series.array = json.value("array", "");
  series.names = json.value("names", std::vector<std::string>{});
  const Json columns = json.value("columns", Json::object());
  for (const auto& item : columns.items()) series.columns[item.key()] = column_from(item.value());
  series.units = json.value("units", std::map<std::string, std::string>{});
  const Json sign = json.value("sign", Json::object());
  const auto positive = [&](const char* of) -> std::optional<Positive> {
    if (!sign.contains(of)) return std::nullopt;
    return value_of<Positive>(sign[of].get<std::string>(), of);
  };
  series.stress_sign = positive("stress");
  series.strain_sign = positive("strain");
  series.nominal = json.value("measure", "logarithmic") == "nominal";
  series.engineering_shear = json.value("shear", "tensor") == "engineering";
  series.isotropic = json.value("isotropic", false);
  series.axis = json.value("axis", "z").front() - 'x';
  if (json.contains("nu_start")) series.nu_start = json["nu_start"].get<double>();
  return series;
}

/// Stand-ins for mean_radius and stiffness where their ratio is all that is known: <r> = 0.5 m, k = k/(2<r>) 1 m.
void set_stress_unit(double unit, PackingInfo& packing) {
  packing.mean_radius = 0.5;
  packing.stiffness = unit;
}

PackingInfo packing_from(const Json& json, std::uint64_t place, const std::string& where) {
  PackingInfo packing;
  packing.seed = place;
  read_given_fields(json, packing);
  read_given_fields(json, packing.contacts);
  const bool parts = json.contains("mean_radius") || json.contains("stiffness");
  const int ways = (parts ? 1 : 0) + (json.contains("stress_unit") ? 1 : 0) + (json.contains("dimensionless") ? 1 : 0);
  if (ways > 1)
    throw InvalidInput(
        fmt::format("{}: says twice what makes P* of a stress; give mean_radius and stiffness, or stress_unit, or "
                    "dimensionless",
                    where));
  if (json.contains("stress_unit")) set_stress_unit(json["stress_unit"], packing);
  if (json.contains("dimensionless")) set_stress_unit(1, packing);
  return packing;
}

std::map<std::string, PackingInfo> packings_from(const Json& document, const std::string& name) {
  std::map<std::string, PackingInfo> packings;
  std::map<std::uint64_t, std::string> seeds;
  const Json all = document.value("packings", Json::object());
  std::uint64_t place = 0;
  for (const auto& item : all.items()) {  // in the order of the alphabet
    const std::string where = fmt::format("{}: packings.{}", name, one_line(item.key(), 60));
    const PackingInfo packing = packing_from(item.value(), ++place, where);
    const auto [other, fresh] = seeds.try_emplace(packing.seed, item.key());
    if (!fresh)
      throw InvalidInput(
          fmt::format("{}.seed: {} is that of packings.{}, too; packings are told apart by it, give "
                      "each its own",
                      where, packing.seed, one_line(other->second, 60)));
    packings[item.key()] = packing;
  }
  return packings;
}

std::optional<PackingInfo> packing_of(const Json& test, const std::map<std::string, PackingInfo>& packings,
                                      const std::string& where) {
  if (!test.contains("packing")) {
    if (packings.empty()) return std::nullopt;
    if (packings.size() == 1) return packings.begin()->second;
    throw InvalidInput(
        fmt::format("{}: misses the key 'packing'; give the name of one of the {} packings", where, packings.size()));
  }
  const auto found = packings.find(test["packing"].get<std::string>());
  if (found == packings.end())
    throw InvalidInput(fmt::format("{}.packing: '{}' is not one of packings; name one that is", where,
                                   one_line(test["packing"].get<std::string>(), 60)));
  return found->second;
}

TestMapping test_from(const Json& document, const Json& json, const std::map<std::string, PackingInfo>& packings,
                      const Mapping& mapping, const std::string& place) {
  const std::string where = fmt::format("{}: {}", mapping.name, place);
  TestMapping test;
  test.name = json["name"];
  if (!is_safe_name(test.name))
    throw InvalidInput(fmt::format("{}.name: '{}' is no name for a file; rename it", where, one_line(test.name, 60)));
  if (test.name.ends_with(".extra"))  // of the columns that another test leaves over
    throw InvalidInput(fmt::format("{}.name: '{}' ends like the files of extra columns; rename it", where, test.name));
  test.role = value_of<Role>(json["role"].get<std::string>(), "role");
  test.packing = packing_of(json, packings, where);
  if (json.contains("path")) {
    const Json& path = json["path"];
    test.segments = segments_from_json(path["segments"], mapping.name, place + ".path.", false);
    if (path.contains("initial")) {
      test.nu = path["initial"]["nu"].get<double>();
      test.branch = branch_from_json(path["initial"]);
    }
  }
  test.path_tolerance = json.value("path_tolerance", document.value("path_tolerance", TestMapping{}.path_tolerance));
  const Json series = merged(document, json, "series");
  test.particles = merged(document, json, "particles");
  if (series.is_null() == test.particles.is_null())
    throw InvalidInput(fmt::format(
        "{}: {}", where,
        series.is_null() ? "misses its data; give series or particles" : "has series and particles; give one of them"));
  if (series.is_null()) {
    const Json all = document.value("packings", Json::object());
    for (const auto& item : all.items()) {
      const bool stand_in = item.value().contains("stress_unit") || item.value().contains("dimensionless");
      if (stand_in && item.key() == json.value("packing", item.key()))
        throw InvalidInput(
            fmt::format("{}: particles have radii of their own; give 'stiffness' in packings.{} in place "
                        "of stress_unit or dimensionless",
                        where, one_line(item.key(), 60)));
    }
    return test;
  }
  test.series = series_from(series, mapping.folder);
  if (test.series->decimal == ',' && test.series->delimiter == Delimiter::comma)
    throw InvalidInput(
        fmt::format("{}.series: delimiter and decimal are both commas; part the columns otherwise", where));
  return test;
}

}  // namespace

Mapping read_mapping(const fs::path& file) {
  const Json document = read_json(file, JsonSource::user);
  Mapping mapping;
  mapping.name = one_line(file.string(), 200);
  check_schema(document, Schema::mapping, mapping.name);
  mapping.folder = file.parent_path();
  mapping.sha256 = sha256_of_file(file);
  mapping.source = document["source"];
  const std::map<std::string, PackingInfo> packings = packings_from(document, mapping.name);
  std::set<std::string> names;
  for (std::size_t i = 0; i < document["tests"].size(); ++i) {
    const std::string place = fmt::format("tests[{}]", i);
    mapping.tests.push_back(test_from(document, document["tests"][i], packings, mapping, place));
    if (!names.insert(mapping.tests.back().name).second)
      throw InvalidInput(
          fmt::format("{}: {}.name: '{}' is given twice; rename one", mapping.name, place, mapping.tests.back().name));
  }
  return mapping;
}

void require_packing(const Mapping& mapping, const TestMapping& test) {
  const auto misses = [&](const char* key, const char* what) {
    throw InvalidInput(
        fmt::format("{}: the packing of test {} misses the key '{}'; {}", mapping.name, test.name, key, what));
  };
  if (!test.packing) misses("packings", "give it with the number of particles and what makes P* of a stress");
  if (test.packing->particles == 0)
    misses("particles", "give their number, of a sample of soil its order of magnitude");
  if (test.packing->mean_radius == 0)
    misses("mean_radius", "give it with stiffness, or stress_unit, k/(2<r>) in Pa, or \"dimensionless\": true");
  if (test.packing->stiffness == 0) misses("stiffness", "give k in kg/s^2, or stress_unit instead of both");
}

}  // namespace grainlaw::chain
