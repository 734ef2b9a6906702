#pragma once
// SPEC: what a calibration prepares, tests and fits. Every key has a default; which tests are fitted and which only
// validate is fixed here, before anything runs.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dem/element_tests/preparation.hpp"
#include "dem/runs/path_probes.hpp"
#include "model/files/json_document.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::dem {

/// One entry of `tests`: the same test at several densities, on every packing.
struct TestRequest {
  std::string name;                   ///< label in file names
  std::string mode;                   ///< "ISO", "UNI", "D2", "D3", "D2-ISO"; empty: `segments`
  Branch branch = Branch::unloading;  ///< branch of the kept states, or the branch that ISO means
  std::vector<double> densities;      ///< where the test starts; empty for ISO [-]
  double strain = 0;                  ///< deviatoric strain to reach; 0: UNI up to nu_max, otherwise unused [-]
  std::vector<PathSegment> segments;  ///< when `mode` is empty
  Role role = Role::calibration;
  std::optional<ProbeRequest> probes = std::nullopt;  ///< small-strain probes along the test; none in ISO
};

struct Spec {
  PreparationOptions preparation;  ///< for every seed; kept states are those that tests and `keep` ask for
  std::vector<std::uint64_t> seeds{1, 2};
  std::vector<double> densities{0.68, 0.70, 0.72, 0.74, 0.77, 0.80};  ///< ascending [-]
  std::vector<double> keep;  ///< further densities of the unloading branch, for later predictions [-]
  std::vector<TestRequest> tests;
  std::string coupling = "energy";  ///< of the law that is fitted; the engine does not read it
};
/// All keys of SPEC but `tests`, whose entries stand in for each other.
constexpr auto fields_of(std::type_identity<Spec>) {
  return std::tuple{Field{&Spec::preparation, ""}, Field{&Spec::seeds, "seeds"}, Field{&Spec::densities, "densities"},
                    Field{&Spec::keep, "keep"}, Field{&Spec::coupling, "coupling"}};
}

/// Throws InvalidInput naming file, key, reason and remedy.
Spec read_spec(const std::filesystem::path& file);
Spec spec_from_json(const Json& document, const std::string& name);

/// What is known of its packings before they are made: number, width and contacts.
PackingInfo packing_of(const Spec& spec);

/// The effective spec, defaults and derived values included; reading it gives the same spec.
OrderedJson spec_to_json(const Spec& spec);

/// Throws InvalidInput for keys of a SPEC or TEST that the chosen engine does not read.
void refuse_keys_of_other_engine(const Json& document, const EngineChoice& choice, const std::string& name);

/// Path of `test` from `nu`. The ISO branches go from one end of the branch to the other.
Path path_of(const TestRequest& test, double nu, const Spec& spec);

/// The name that a test gets when none is given: its mode or modes, and the branch unless it is the unloading one.
std::string default_name(const TestRequest& test);

/// "D2-0.70-s1": name, density (none for ISO) and seed.
std::string record_name(const TestRequest& test, double nu, std::uint64_t seed);

/// Shortest text of a density with at least two decimals, for file names.
std::string density_text(double nu);

}  // namespace grainlaw::dem
