#pragma once
// What the contacts of a packing know beyond Eq. (1). Nothing of it is known to the engine of dem/engine; LAMMPS has it
// (dem/lammps/), and data of others may.

#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw {

/// Elastic normal force at overlap delta, r_ij = r_i r_j/(r_i + r_j): k delta, or (k/2<r>) sqrt(r_ij delta) delta.
enum class NormalForce { hooke, hertz };
constexpr auto names_of(NormalForce) { return std::array{"hooke", "hertz"}; }

struct ContactModel {
  double friction = 0;                            ///< mu: largest tangential over normal force [-]
  double rolling_friction = 0;                    ///< mu_r: likewise of the resistance to rolling [-]
  NormalForce normal_force = NormalForce::hooke;  ///< k stands for a stiffness of Hertz times 2<r>
  double cohesion = 0;                            ///< surface energy w: contacts pull with 4 pi w r_ij (DMT) [J/m^2]

  bool operator==(const ContactModel&) const = default;
};
constexpr auto fields_of(std::type_identity<ContactModel>) {
  using C = ContactModel;
  return std::tuple{
      Field{&C::friction, "friction", "", "mu", "coefficient of friction of the contacts"},
      Field{&C::rolling_friction, "rolling_friction", "", "mu_r", "coefficient of rolling friction"},
      Field{&C::normal_force, "normal_force", "", "", "elastic force of a contact: k delta, or that of Hertz"},
      Field{&C::cohesion, "cohesion", "J/m^2", "w", "surface energy of cohesive contacts (DMT); needs hertz"}};
}
static_assert(tells_every_member<ContactModel>());

}  // namespace grainlaw
