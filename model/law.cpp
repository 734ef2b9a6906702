#include "model/law.hpp"

#include "model/vocabulary/error.hpp"

namespace grainlaw {

std::string to_string(Rung rung) {
  switch (rung) {
    case Rung::reduced:
      return "reduced";
    case Rung::evolution:
      return "evolution";
    case Rung::memory:
      break;
  }
  return "memory";
}

Rung rung_of(const std::string& name) {
  for (const Rung rung : kRungs) {
    if (name == to_string(rung)) return rung;
  }
  throw InvalidInput("'" + name + "' is no rung of the law; give reduced, evolution or memory");
}

}  // namespace grainlaw
