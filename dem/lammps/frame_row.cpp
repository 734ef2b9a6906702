#include "dem/lammps/frame_row.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "dem/engine/averages.hpp"
#include "dem/foreign/frame.hpp"
#include "dem/lammps/program.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kSameForce = 1e-8;   // of the largest: what rounding may take of a small overlap
constexpr double kSameStress = 1e-6;  // of the contacts that are listed and of all forces
constexpr double kNoStress = 1e-12;   // of k/<r>
constexpr double kSameRough = 1e-4;   // with friction: LAMMPS turns a tangential spring with its contact a step late

ParticleRequest request_of(const std::filesystem::path& folder, const std::string& name, const DeckSpheres& spheres) {
  ParticleRequest request;
  request.where = "LAMMPS";
  request.format = ParticleFormat::lammps_dump;
  request.files = {folder / (name + ".spheres")};
  request.stiffness = spheres.material.stiffness;
  request.density = spheres.material.density;
  const auto columns = [](int first) {
    std::array<std::string, 3> titles;
    for (int a = 0; a < 3; ++a) titles[static_cast<std::size_t>(a)] = fmt::format("c_contact[{}]", first + a);
    return titles;
  };
  ContactRequest& contacts = request.contacts.emplace();
  contacts.files = {folder / (name + ".contacts")};
  contacts.first = kFirst;
  contacts.second = kSecond;
  contacts.force = columns(1);
  contacts.tangential = columns(4);
  contacts.branch = columns(7);
  return request;
}

/// Net forces, and whether each normal force is that of the law.
void weigh(const Frame& frame, const DeckSpheres& spheres, Look& look) {
  const Packing& p = frame.packing;
  std::vector<Eigen::Vector3d> net(p.size(), Eigen::Vector3d::Zero());
  double largest = 0, off = 0, sum = 0;
  std::size_t touching = 0, worst = 0;
  for (const ListedContact& c : frame.contacts) {
    if (c.force.isZero(0)) continue;
    const std::size_t i = c.first, j = c.second;
    const double distance = c.branch.norm(), reach = p.radius[i] + p.radius[j];
    const Eigen::Vector3d n = c.branch / distance;
    const Eigen::Vector3d v(p.vx[i] - p.vx[j], p.vy[i] - p.vy[j], p.vz[i] - p.vz[j]);
    const double expected = elastic_force(spheres.material, spheres.contacts, spheres.mean_radius,
                                          p.radius[i] * p.radius[j] / reach, reach - distance) -
                            spheres.material.contact_viscosity * v.dot(n);
    net[i] += c.force;
    net[j] -= c.force;
    sum += c.force.norm();
    ++touching;
    largest = std::max(largest, std::abs(expected));
    if (std::abs(c.force.dot(n) - expected) > off) off = std::abs(c.force.dot(n) - expected), worst = c.line;
  }
  if (!(off <= (spheres.contacts.friction > 0 ? kSameRough : kSameForce) * largest))
    throw Error(
        fmt::format("{}: line {}: LAMMPS's normal force is {:.3g} N off the law that it was asked for, where the "
                    "largest is {:.3g} N; "
                    "this version does not mean the same by its commands, give one that is known: {}",
                    frame.contacts_source.file.string(), worst, off, largest, kKnownLammps));
  for (const Eigen::Vector3d& force : net) look.max_net_force = std::max(look.max_net_force, force.norm());
  look.mean_contact_force = touching == 0 ? 0 : sum / static_cast<double>(touching);
}

}  // namespace

Look read_look(const std::filesystem::path& folder, const std::string& mark, const State& like,
               const DeckSpheres& spheres, const Eigen::Matrix3d& L, const Deviator<double>& N) {
  std::istringstream words(mark);
  words.exceptions(std::ios::badbit);
  std::string name;
  Eigen::Vector3d stress;
  words >> name >> stress[0] >> stress[1] >> stress[2];
  Frame frame;
  Look look;
  try {
    const ParticleRequest request = request_of(folder, name, spheres);
    Frames frames(request);
    if (!frames.next(frame)) throw InvalidInput(request.files[0].string() + ": is empty");
    if (frame.packing.size() != like.packing.size())
      throw InvalidInput(fmt::format("{}: has {} spheres of {}", request.files[0].string(), frame.packing.size(),
                                     like.packing.size()));
    weigh(frame, spheres, look);
    const bool may_pull = spheres.contacts.cohesion > 0;
    set_averages(look.row, sum_given(frame.packing, frame.contacts, may_pull).sums, frame.packing,
                 spheres.material.stiffness, N, false);
    const Eigen::Vector3d off = look.row.stress.tensor.diagonal() - stress;
    const double unit = spheres.material.stiffness / spheres.mean_radius;
    if (!words || !(off.norm() <= kSameStress * stress.norm() + kNoStress * unit))
      throw Error(
          fmt::format("{}: the contacts that LAMMPS lists make a stress that is {:.3g} of its own off it: the "
                      "springs are mixed up",
                      request.contacts->files[0].string(), off.norm() / stress.norm()));
    for (const char* end : {".spheres", ".contacts"}) std::filesystem::remove(folder / (name + end));
  } catch (const InvalidInput& error) {
    throw Error(fmt::format("what LAMMPS has written cannot be read; is the disk full? {}", error.what()));
  }
  State& state = look.state;
  state.material = like.material;
  state.seed = like.seed;
  state.packing = std::move(frame.packing);
  state.packing.id = like.packing.id;
  look.row.stress_kinetic.tensor = kinetic_stress(state.packing);
  look.row.E_kin = kinetic_energy(state.packing);
  look.row.inertial_number =
      inertial_number(L, look.row.stress.tensor.trace() / 3, spheres.mean_radius, spheres.material.density);
  return look;
}

}  // namespace grainlaw::dem
