#include "dem/element_tests/engine_choice.hpp"

#include <fmt/format.h>

#include "dem/element_tests/drive.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {

void check(const EngineChoice& choice, const EngineOptions& engine, const DriveOptions& drive) {
  const auto refuse_if = [](bool wrong, const char* key, const char* why) {
    if (wrong) throw InvalidInput(fmt::format("{}: {}", key, why));
  };
  const ContactModel& contacts = choice.contacts;
  if (!choice.is_lammps()) {
    const char* why = "the engine 'grainlaw' does not have it; give \"engine\": \"lammps\", or remove it";
    refuse_if(contacts.friction != 0, "friction", why);
    refuse_if(contacts.rolling_friction != 0, "rolling_friction", why);
    refuse_if(contacts.normal_force != NormalForce::hooke, "normal_force", why);
    refuse_if(contacts.cohesion != 0, "cohesion", why);
    refuse_if(drive.quasi_static_step > 0 && drive.transport == Transport::wall, "quasi_static_step",
              "spheres move with the cell; leave transport homogeneous");
    return;
  }
  refuse_if(contacts.rolling_friction > 0 && contacts.friction == 0, "rolling_friction",
            "spheres that slide do not roll; give friction, too");
  refuse_if(contacts.cohesion > 0 && contacts.normal_force != NormalForce::hertz, "cohesion",
            "is that of Derjaguin, Muller and Toporov, of Hertz's contacts; give \"normal_force\": \"hertz\"");
  const char* ours = "belongs to the engine 'grainlaw'; remove it";
  refuse_if(drive.quasi_static_step > 0, "quasi_static_step", ours);
  refuse_if(drive.transport != Transport::homogeneous, "transport", ours);
  refuse_if(engine.portable_bits, "portable_bits", ours);
}

}  // namespace grainlaw::dem
