#pragma once
// Which program runs the particles of a preparation or a test: ours (dem/engine) or LAMMPS (dem/lammps), and what their
// contacts know.

#include "model/vocabulary/contact_model.hpp"

namespace grainlaw::dem {

struct EngineOptions;
struct DriveOptions;

enum class EngineName { grainlaw, lammps };
constexpr auto names_of(EngineName) { return std::array{"grainlaw", "lammps"}; }

struct EngineChoice {
  EngineName engine = EngineName::grainlaw;
  ContactModel contacts;

  bool is_lammps() const { return engine == EngineName::lammps; }
  /// Whether contacts remember: their springs are then in restart files of LAMMPS alone.
  bool has_history() const { return contacts.friction > 0; }
};
constexpr auto fields_of(std::type_identity<EngineChoice>) {
  using E = EngineChoice;
  return std::tuple{Field{&E::engine, "engine", "", "", "program that runs the particles"}, Field{&E::contacts, ""}};
}
static_assert(tells_every_member<EngineChoice>());

/// Keys of SPEC and TEST that LAMMPS does not read: how our engine computes, and what it alone shows along a path.
inline constexpr std::array kOurEngineAlone{"skin",      "precision", "portable_bits", "quasi_static_step",
                                            "transport", "probes",    "frames"};

/// Throws InvalidInput "KEY: ..." for what the chosen engine does not have.
void check(const EngineChoice& choice, const EngineOptions& engine, const DriveOptions& drive);

}  // namespace grainlaw::dem
