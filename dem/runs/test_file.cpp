#include "dem/runs/test_file.hpp"

#include <fmt/format.h>

#include "dem/files/sphere_table.hpp"
#include "dem/files/state_file.hpp"
#include "dem/runs/feasibility.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/files/digest.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

Eigen::Matrix3d cell_from(const Json& rows) {
  Eigen::Matrix3d H;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) H(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].get<double>();
  }
  return H;
}

/// Keys of a packing that is made here say nothing about one that is given.
void refuse_unread_keys(const Json& document, Start start, const std::string& name) {
  if (start != Start::spheres && start != Start::state) return;
  const bool spheres = start == Start::spheres;
  const auto refuse = [&](const char* key, const char* why) {
    if (document.contains(key)) throw InvalidInput(fmt::format("{}: {}: {}", name, key, why));
  };
  const char* made = "belongs to a packing that is made, but here it is given; remove it";
  for_each_field<PackingOptions>([&](const auto& field) { refuse(field.name, made); });
  for (const char* key : {"nu_start", "nu_max", "nu_end"}) refuse(key, made);
  if (spheres) return;
  for_each_field<Material>([&](const auto& field) {
    refuse(field.name,
           "is not read, the state has its own; remove it, or give the spheres of the state (end.csv) and their 'cell' "
           "in place of 'state', to which it applies");
  });
}

Start start_from(const Json& document, const std::string& name) {
  Start start = Start::preparation;
  int given = 0;
  for (const auto& [key, value] :
       {std::pair{"initial", Start::kept}, {"spheres", Start::spheres}, {"state", Start::state}}) {
    if (!document.contains(key)) continue;
    start = value;
    ++given;
  }
  if (given > 1) throw InvalidInput(fmt::format("{}: initial, spheres and state exclude each other; give one", name));
  if (start == Start::preparation && document.contains("segments")) {
    throw InvalidInput(fmt::format("{}: segments: start nowhere; give initial, spheres or state", name));
  }
  const auto only_with = [&](const char* key, Start wanted, const char* what) {
    if (document.contains(key) && start != wanted)
      throw InvalidInput(fmt::format("{}: {}: belongs to {}; remove it", name, key, what));
  };
  only_with("cell", Start::spheres, "spheres");
  if (document.contains("relax") && start != Start::spheres && start != Start::state) {
    throw InvalidInput(
        fmt::format("{}: relax: belongs to spheres or state, a preparation relaxes what it keeps; remove it", name));
  }
  only_with("keep", Start::preparation, "a preparation without segments");
  if (document.contains("probes") && start == Start::preparation) {
    throw InvalidInput(fmt::format("{}: probes: belong to a test; give initial, spheres or state", name));
  }
  if (document.contains("frames") && start == Start::preparation) {
    throw InvalidInput(fmt::format("{}: frames: belong to a test; give initial, spheres or state", name));
  }
  if (start == Start::spheres && !document.contains("cell")) {
    throw InvalidInput(fmt::format("{}: misses the key 'cell'; give three rows of three numbers [m]", name));
  }
  if (start == Start::kept && !document.contains("segments")) {
    throw InvalidInput(
        fmt::format("{}: misses the key 'segments'; give the path from 'initial', or 'keep' instead of it", name));
  }
  refuse_unread_keys(document, start, name);
  return start;
}

/// What no simulation could start from.
void check_given(const State& given, const PreparationOptions& options, bool relaxed, const std::string& name) {
  const EngineOptions& engine = options.engine;
  try {
    check(options.choice, engine, options.drive);
    if (options.choice.is_lammps() && !given.packing.H.isDiagonal(0))
      throw InvalidInput("cell: is sheared; LAMMPS is given upright cells only");
    if (relaxed && options.choice.contacts.normal_force != NormalForce::hooke)
      throw InvalidInput(
          "relax: is done by k delta, not by the normal_force that is asked for; relax the spheres before");
    if (!(given.contacts == ContactModel{}) && !(given.contacts == options.choice.contacts))
      throw InvalidInput(
          "state: was made with other contacts than the test's; give the same friction, rolling_friction, normal_force "
          "and cohesion with \"engine\": \"lammps\", or its spheres (end.csv) and 'cell' in place of 'state'");
    check(given.material);
    check_sizes(given.packing);
    check_time_step(engine.time_step_fraction, given.material, lightest_pair(given.packing));
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
}

/// So that steps and rates are judged by the spheres that are given: smallest radius 2<r>/(w + 1).
void take_sizes(const State& given, PackingOptions& packing) {
  packing.material = given.material;
  packing.mean_radius = mean_radius(given.packing);
  packing.size_width = 2 * packing.mean_radius / std::ranges::min(given.packing.radius) - 1;
}

}  // namespace

TestFile test_from_document(const Json& document, const std::filesystem::path& folder, const std::string& name) {
  check_schema(document, Schema::test, name);
  TestFile test;
  test.start = start_from(document, name);
  PreparationOptions& preparation = test.preparation;
  read_given_fields(document, preparation);
  test.rows = preparation.rows;
  refuse_keys_of_other_engine(document, preparation.choice, name);
  preparation.packing.seed = document.value("seed", preparation.packing.seed);
  test.relax = document.value("relax", false);
  test.frames = document.value("frames", 0);
  if (document.contains("probes")) read_given_fields(document["probes"], test.probes.emplace());
  const auto keep = [&](const Json& kept) {
    (branch_from_json(kept) == Branch::loading ? preparation.keep_loading : preparation.keep_unloading)
        .push_back(kept["nu"].get<double>());
  };
  if (test.start == Start::kept) keep(document["initial"]);
  if (document.contains("keep")) {
    for (const Json& kept : document["keep"]) keep(kept);
  }
  for (auto* densities : {&preparation.keep_loading, &preparation.keep_unloading}) std::ranges::sort(*densities);
  const bool made = test.start == Start::preparation || test.start == Start::kept;
  if (made) complete_preparation(preparation, name);
  if (test.start == Start::preparation) return test;

  if (test.start == Start::spheres) {
    test.given_file = folder / document["spheres"].get<std::string>();
    test.given = read_spheres(test.given_file, cell_from(document["cell"]), preparation.packing.material);
    test.given_digest = sha256(sha256_of_file(test.given_file) + document["cell"].dump());
  } else if (test.start == Start::state) {
    test.given_file = folder / document["state"].get<std::string>();
    test.given = read_state(test.given_file);
    test.given_digest = sha256_of_file(test.given_file);
  }
  if (test.given) {
    check_given(*test.given, preparation, test.relax, name);
    take_sizes(*test.given, preparation.packing);
  }
  Json path{{"initial", document.value("initial", Json::object())},
            {"segments", document.value("segments", Json::array())}};
  if (test.given) path["initial"]["nu"] = volume_fraction(test.given->packing);
  test.path = path_from_json(path, name, "", false);
  check_path(test.path, preparation, name);
  return test;
}

TestFile read_test(const std::filesystem::path& file) {
  return test_from_document(read_json(file, JsonSource::user), file.parent_path(), one_line(file.string(), 200));
}

}  // namespace grainlaw::dem
