#pragma once
// One element test: what was done to which packing, and the series that was seen. The unit of the data set.

#include <cstdint>
#include <string>
#include <vector>

#include "model/vocabulary/contact_model.hpp"
#include "model/vocabulary/observation.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw {

/// What a test is for, fixed before it runs.
enum class Role {
  calibration,  ///< fitted
  validation,   ///< never shown to a fit
  description,  ///< fitted by laws of its own (Table 2's UNI and D3), which the calibrated law does not read
  rehearsal,    ///< never shown to a fit; says afterwards how far the law is off on paths that none saw
};
constexpr auto names_of(Role) { return std::array{"calibration", "validation", "description", "rehearsal"}; }

/// What a reader of a series must know about the packing it came from.
struct PackingInfo {
  std::uint64_t seed = 0;      ///< seed of the packing
  std::int64_t particles = 0;  ///< number of spheres
  double size_width = 0;       ///< w = r_max/r_min of the uniform distribution [-]
  double mean_radius = 0;      ///< <r> of this packing [m]
  double stiffness = 0;        ///< k [kg/s^2]
  ContactModel contacts = {};  ///< what its contacts know; in dataset.json where it is more than Eq. (1)

  double stress_unit() const { return stiffness / (2 * mean_radius); }  ///< k/(2<r>) = stress of P* = 1 [Pa]
};
constexpr auto fields_of(std::type_identity<PackingInfo>) {
  using P = PackingInfo;
  return std::tuple{Field{&P::seed, "seed"},
                    Field{&P::particles, "particles"},
                    Field{&P::size_width, "size_width"},
                    Field{&P::mean_radius, "mean_radius", "m"},
                    Field{&P::stiffness, "stiffness", "kg/s^2"},
                    Field{&P::contacts, "contacts", "", "", "", Rule::free}};  // so that digests without it stay
}
static_assert(tells_every_member<PackingInfo>());

/// What sets the material of `ours` apart from that of `theirs`: "size_width of its packing: 1, but 3"; empty for one material.
/// A width of 0 is unknown. The size and the stiffness of the spheres are units, and their number is none of it.
std::string other_material(const PackingInfo& ours, const PackingInfo& theirs);

struct TestRecord {
  std::string name;  ///< file name of the series without its extension; letters, digits, '.', '-', '_'
  Role role = Role::calibration;
  Path path;  ///< start and segments
  PackingInfo packing;
  std::vector<Observation> rows;  ///< first row: the start of the test; times increase
};

/// True when the test is one isotropic segment of the named sense (compression or decompression).
bool is_isotropic_loading(const TestRecord& test);
bool is_isotropic_unloading(const TestRecord& test);
/// True when the test is a single segment of constant-volume shear (D2, D3 or such a tensor).
bool is_pure_shear(const TestRecord& test);

}  // namespace grainlaw
