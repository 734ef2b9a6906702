#include "dem/runs/spec_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "dem/runs/feasibility.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kShearStrain = 0.3;    // steady means are taken from 0.15 on
constexpr double kPreshear = 0.15;      // of D2-ISO, equations.md 0
constexpr double kIsoExcursion = 0.03;  // rise of nu in D2-ISO, equations.md 0

double default_strain(const std::string& mode) {
  if (mode == "D2" || mode == "D3") return kShearStrain;
  return mode == "D2-ISO" ? kPreshear : 0;
}

TestRequest test_from_json(const Json& object, const std::vector<double>& densities, const std::string& name,
                           const std::string& place) {
  const auto refuse = [&](const std::string& what) { throw InvalidInput(fmt::format("{}: {}{}", name, place, what)); };
  TestRequest test;
  test.mode = object.value("mode", "");
  test.branch = branch_from_json(object);
  test.role = value_of<Role>(object["role"].get<std::string>(), "role");
  if (test.mode.empty() != object.contains("segments")) {
    refuse(test.mode.empty() ? ": misses what to do; give mode or segments"
                             : ": has mode and segments; give one of them");
  }
  if (test.mode.empty()) test.segments = segments_from_json(object["segments"], name, place + ".", true);
  if (test.mode == "ISO") {
    for (const char* key : {"density", "strain", "probes"}) {
      if (object.contains(key))
        refuse(fmt::format(".{}: ISO is the preparation's own branch and takes none; remove it or give segments", key));
    }
  } else {
    const Json density = object.value("density", Json("all"));
    test.densities = density.is_string()  ? densities
                     : density.is_array() ? density.get<std::vector<double>>()
                                          : std::vector<double>{density.get<double>()};
    std::sort(test.densities.begin(), test.densities.end());
  }
  if (object.contains("strain") && test.mode.empty())
    refuse(".strain: belongs to a mode; write it into the segments' extents");
  test.strain = object.value("strain", default_strain(test.mode));
  if (object.contains("probes")) read_given_fields(object["probes"], test.probes.emplace());
  test.name = object.value("name", default_name(test));
  if (!is_safe_name(test.name))
    refuse(fmt::format(".name: '{}' is no name; use letters, digits, '.', '-', '_'", one_line(test.name, 60)));
  return test;
}

/// ISO unloading, D2 and D2-ISO at every density.
std::vector<TestRequest> default_tests(const std::vector<double>& densities) {
  std::vector<TestRequest> tests;
  for (const char* mode : {"ISO", "D2", "D2-ISO"}) {
    TestRequest test;
    test.mode = mode;
    if (test.mode != "ISO") test.densities = densities;
    test.strain = default_strain(mode);
    test.name = default_name(test);
    tests.push_back(test);
  }
  return tests;
}

/// One run of a packing may be fitted once, and then judges nothing; descriptions are fits of their own.
bool may_share_a_run(Role a, Role b) {
  const bool fitted = a == Role::calibration || b == Role::calibration;
  return !fitted || a == Role::description || b == Role::description;
}

/// Paths that can be followed, names that differ, runs that end and are not both fitted and judged.
void check_tests(const Spec& spec, const std::string& name) {
  std::set<std::string> names;
  std::vector<std::pair<Path, std::size_t>> runs;  // and whose test they are
  for (std::size_t i = 0; i < spec.tests.size(); ++i) {
    const TestRequest& test = spec.tests[i];
    const std::vector<double> starts = test.mode == "ISO" ? std::vector<double>{0} : test.densities;
    for (const double nu : starts) {
      if (!names.insert(record_name(test, nu, 0)).second) {
        throw InvalidInput(fmt::format(
            "{}: tests[{}].name: '{}' is the name of an earlier test; give one of them another", name, i, test.name));
      }
      const Path path = path_of(test, nu, spec);
      if (test.mode != "ISO") check_path(path, spec.preparation, fmt::format("{}: tests[{}]: at nu = {}", name, i, nu));
      for (const auto& [known, at] : runs) {
        const Role other = spec.tests[at].role;
        if (may_share_a_run(test.role, other) || !same_path(known, path)) continue;
        throw InvalidInput(fmt::format(
            "{}: tests[{}]: '{}' ({}) is the run of tests[{}] ({}) on the same packings; what is fitted is "
            "fitted once and judges nothing, remove one or give it another path",
            name, i, record_name(test, nu, spec.seeds.front()), to_string(test.role), at, to_string(other)));
      }
      runs.emplace_back(path, i);
    }
  }
}

/// States that tests start from and that `keep` asks for.
void collect_kept(Spec& spec) {
  std::set<double> loading, unloading(spec.keep.begin(), spec.keep.end());
  for (const TestRequest& test : spec.tests)
    (test.branch == Branch::loading ? loading : unloading).insert(test.densities.begin(), test.densities.end());
  spec.preparation.keep_loading.assign(loading.begin(), loading.end());
  spec.preparation.keep_unloading.assign(unloading.begin(), unloading.end());
}

OrderedJson test_to_json(const TestRequest& test) {
  OrderedJson object = OrderedJson::object();
  object["name"] = test.name;
  if (!test.mode.empty()) object["mode"] = test.mode;
  object["branch"] = to_string(test.branch);
  if (test.mode != "ISO") object["density"] = test.densities;
  if (test.strain > 0) object["strain"] = test.strain;
  if (test.mode.empty()) object["segments"] = segments_to_json(test.segments);
  object["role"] = to_string(test.role);
  if (test.probes) object["probes"] = fields_to_json(*test.probes);
  return object;
}

}  // namespace

std::string default_name(const TestRequest& test) {
  if (test.mode == "ISO") return fmt::format("ISO-{}", to_string(test.branch));
  std::string name = test.mode;
  if (name.empty()) {
    for (const PathSegment& segment : test.segments)
      name += fmt::format("{}{}", name.empty() ? "" : "-", to_string(segment.mode));
    if (name.size() > 40) name = fmt::format("path-of-{}", test.segments.size());
  }
  return test.branch == Branch::loading ? fmt::format("{}-loading", name) : name;
}

std::string density_text(double nu) {
  std::string text = fmt::format("{}", nu);
  const auto point = text.find('.');
  if (point == std::string::npos) return text + ".00";
  while (text.size() < point + 3) text += '0';
  return text;
}

std::string record_name(const TestRequest& test, double nu, std::uint64_t seed) {
  return test.mode == "ISO" ? fmt::format("{}-s{}", test.name, seed)
                            : fmt::format("{}-{}-s{}", test.name, density_text(nu), seed);
}

Path path_of(const TestRequest& test, double nu, const Spec& spec) {
  const auto iso = [](double target, bool reverse) {
    return PathSegment{Mode::ISO, direction_of(Mode::ISO, "xyz", reverse), ExtentKind::target_nu, target};
  };
  const auto shear = [&](Mode mode) { return PathSegment{mode, direction_of(mode), ExtentKind::eps_dev, test.strain}; };
  Path path{nu, test.branch, test.segments};
  if (test.mode == "ISO") {
    const bool loading = test.branch == Branch::loading;
    const double end = spec.preparation.nu_end.value_or(spec.preparation.nu_start);
    path.nu = loading ? spec.preparation.nu_start : spec.preparation.nu_max;
    path.segments = {iso(loading ? spec.preparation.nu_max : end, !loading)};
  } else if (test.mode == "UNI") {
    path.segments = {shear(Mode::UNI)};
    if (test.strain == 0)
      path.segments = {{Mode::UNI, direction_of(Mode::UNI), ExtentKind::target_nu, spec.preparation.nu_max}};
  } else if (test.mode == "D2") {
    path.segments = {shear(Mode::D2)};
  } else if (test.mode == "D3") {
    path.segments = {shear(Mode::D3)};
  } else if (test.mode == "D2-ISO") {
    path.segments = {shear(Mode::D2), iso(nu + kIsoExcursion, false), iso(nu, true)};
  }
  return path;
}

Spec spec_from_json(const Json& document, const std::string& name) {
  check_schema(document, Schema::spec, name);
  Spec spec;
  read_given_fields(document, spec);
  refuse_keys_of_other_engine(document, spec.preparation.choice, name);
  std::sort(spec.densities.begin(), spec.densities.end());
  std::sort(spec.keep.begin(), spec.keep.end());
  if (document.contains("tests")) {
    for (std::size_t i = 0; i < document["tests"].size(); ++i) {
      const std::string place = fmt::format("tests[{}]", i);
      refuse_keys_of_other_engine(document["tests"][i], spec.preparation.choice, name + ": " + place);
      spec.tests.push_back(test_from_json(document["tests"][i], spec.densities, name, place));
    }
  } else {
    spec.tests = default_tests(spec.densities);
  }
  collect_kept(spec);
  complete_preparation(spec.preparation, name);
  check_tests(spec, name);
  return spec;
}

Spec read_spec(const std::filesystem::path& file) {
  return spec_from_json(read_json(file, JsonSource::user), one_line(file.string(), 200));
}

void refuse_keys_of_other_engine(const Json& document, const EngineChoice& choice, const std::string& name) {
  if (!choice.is_lammps()) return;
  for (const char* key : kOurEngineAlone) {
    if (document.contains(key))
      throw InvalidInput(fmt::format("{}: {}: belongs to the engine 'grainlaw'; remove it", name, key));
  }
}

PackingInfo packing_of(const Spec& spec) {
  const PreparationOptions& prepared = spec.preparation;
  return {.particles = prepared.packing.particles,
          .size_width = prepared.packing.size_width,
          .contacts = prepared.choice.contacts};
}

OrderedJson spec_to_json(const Spec& spec) {
  OrderedJson object = fields_to_json(spec);
  if (spec.preparation.choice.is_lammps()) {
    for (const char* key : kOurEngineAlone) object.erase(key);
  } else {
    for_each_field<ContactModel>([&](const auto& field) { object.erase(field.name); });
  }
  OrderedJson& tests = object["tests"] = OrderedJson::array();
  for (const TestRequest& test : spec.tests) tests.push_back(test_to_json(test));
  return object;
}

}  // namespace grainlaw::dem
