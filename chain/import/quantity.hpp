#pragma once
// What a column of a foreign table may mean, by which names it is known, and what its unit is worth in ours.

#include <optional>
#include <string>
#include <vector>

namespace grainlaw::chain {

enum class UnitKind { number, strain, length, stress, time };

struct Quantity {
  std::string name;  ///< in a mapping: our column, or p, q, P_star, eps_a, eps_v, Lx, Ly, Lz, void_ratio, porosity
  UnitKind kind;
  std::string meaning;               ///< one line
  std::vector<std::string> aliases;  ///< by which it is guessed: letters and digits in lower case
  bool exact = false;                ///< one letter: upper and lower case differ
};

/// All of them, the tensors by components.
const std::vector<Quantity>& quantities();

/// Of that name; nothing when there is none.
const Quantity* find_quantity(const std::string& name);

/// A title in two: "sxx" and "kPa" of "sxx[kPa]", "sxx (kPa)", "sxx_kPa". No unit where none is told.
struct Title {
  std::string name;
  std::optional<std::string> unit;
};
Title parted(const std::string& title);

/// What a column called `name` is guessed to be; nothing when that is not plain.
const Quantity* guessed(const std::string& name);

/// What one of `unit` is in SI, of a pure number 1; nothing for a unit that is not one of its kind. A stress without unit is P*.
std::optional<double> factor_of(UnitKind kind, const std::string& unit);

/// "Pa, kPa, ...".
std::string known_units(UnitKind kind);

}  // namespace grainlaw::chain
