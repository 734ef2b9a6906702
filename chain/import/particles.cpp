#include "chain/import/particles.hpp"

#include <fmt/format.h>

#include "dem/foreign/particle_series.hpp"
#include "model/files/digest.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

/// Name and digest of each file.
OrderedJson digests_of(const std::vector<std::filesystem::path>& files) {
  OrderedJson digests = OrderedJson::array();
  for (const auto& file : files) digests.push_back({{"file", file.string()}, {"sha256", sha256_of_file(file)}});
  return digests;
}

}  // namespace

ForeignRows read_particle_rows(const Mapping& mapping, const TestMapping& test, const RunControl& control) {
  const std::string where = fmt::format("{}: test {}: particles", mapping.name, test.name);
  Json particles = test.particles;
  if (!particles.contains("stiffness") && test.packing && test.packing->stiffness > 0)
    particles["stiffness"] = test.packing->stiffness;
  const dem::ParticleRequest request = dem::particle_request(particles, mapping.folder, where);
  if (test.packing && !(test.packing->contacts == ContactModel{}) && !request.contacts)
    throw InvalidInput(where + ": the packing's contacts are others than k delta; give 'contacts' with the forces");
  dem::ParticleSeries series = dem::read_particles(request, control);
  if (series.sheared) throw InvalidInput(*series.sheared);

  ForeignRows foreign;
  foreign.rows = std::move(series.rows);
  foreign.place = [places = series.places](std::size_t row, const std::string& column) {
    return fmt::format("{}: '{}' of the averages", places[row], column);
  };
  foreign.notes = series.notes;
  foreign.columns.push_back({"spheres, " + to_string(request.format), "id, position, radius", "SI", ""});
  if (request.contacts) foreign.columns.push_back({"contacts", "force on the sphere of the id", "SI", ""});
  foreign.packing = test.packing.value_or(PackingInfo{});
  foreign.packing->particles = series.packing.particles;
  foreign.packing->mean_radius = series.packing.mean_radius;
  foreign.packing->stiffness = series.packing.stiffness;
  foreign.provenance = {{"particles", OrderedJson(particles)}, {"files", digests_of(request.files)}};
  if (request.contacts) foreign.provenance["contacts"] = digests_of(request.contacts->files);
  foreign.provenance["notes"] = foreign.notes;
  return foreign;
}

}  // namespace grainlaw::chain
