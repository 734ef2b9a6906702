#include "chain/import/quantity.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include "model/files/number_text.hpp"
#include "model/vocabulary/tensor.hpp"

namespace grainlaw::chain {
namespace {

struct Unit {
  UnitKind kind;
  const char* name;
  double factor;
};
constexpr std::array kUnits{
    Unit{UnitKind::stress, "Pa", 1},      Unit{UnitKind::stress, "kPa", 1e3},    Unit{UnitKind::stress, "MPa", 1e6},
    Unit{UnitKind::stress, "GPa", 1e9},   Unit{UnitKind::stress, "hPa", 1e2},    Unit{UnitKind::stress, "bar", 1e5},
    Unit{UnitKind::stress, "N/m^2", 1},   Unit{UnitKind::stress, "N/mm^2", 1e6}, Unit{UnitKind::strain, "", 1},
    Unit{UnitKind::strain, "-", 1},       Unit{UnitKind::strain, "%", 1e-2},     Unit{UnitKind::strain, "m/m", 1},
    Unit{UnitKind::strain, "mm/m", 1e-3}, Unit{UnitKind::number, "", 1},         Unit{UnitKind::number, "-", 1},
    Unit{UnitKind::number, "%", 1e-2},    Unit{UnitKind::length, "m", 1},        Unit{UnitKind::length, "cm", 1e-2},
    Unit{UnitKind::length, "mm", 1e-3},   Unit{UnitKind::length, "um", 1e-6},    Unit{UnitKind::length, "µm", 1e-6},
    Unit{UnitKind::length, "", 1},        Unit{UnitKind::time, "s", 1},          Unit{UnitKind::time, "ms", 1e-3},
    Unit{UnitKind::time, "us", 1e-6},     Unit{UnitKind::time, "min", 60},       Unit{UnitKind::time, "h", 3600},
    Unit{UnitKind::time, "", 1}};

/// Six quantities with names like sigma_xx, s12.
void add_tensor(const std::string& name, UnitKind kind, const std::string& meaning, std::vector<std::string> words,
                std::vector<Quantity>& all) {
  for (std::size_t c = 0; c < kComponentName.size(); ++c) {
    const auto [i, j] = kComponentIndex[c];
    std::vector<std::string> aliases;
    for (const std::string& word : words) {
      for (const auto& [a, b] : {std::pair{i, j}, {j, i}}) {
        aliases.push_back(word + std::string{static_cast<char>('x' + a), static_cast<char>('x' + b)});
        aliases.push_back(word + std::string{static_cast<char>('1' + a), static_cast<char>('1' + b)});
      }
    }
    all.push_back({name + "_" + kComponentName[c], kind, meaning, aliases});
  }
}

/// Greek letters by their names, the rest in lower case without what is neither letter nor digit.
std::string plain(std::string name) {
  for (const auto& [letter, word] : {std::pair{"σ", "sigma"}, {"ε", "eps"}, {"ν", "nu"}, {"φ", "phi"}, {"*", "star"}}) {
    for (std::size_t at; (at = name.find(letter)) != std::string::npos;)
      name.replace(at, std::string(letter).size(), word);
  }
  std::string text;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = [] {
    using enum UnitKind;
    std::vector<Quantity> list{
        {"time", time, "time", {"time", "t"}},
        {"Lx", length, "edge of the cell along x", {"lx", "boxx", "boxlx"}},
        {"Ly", length, "edge of the cell along y", {"ly", "boxy", "boxly"}},
        {"Lz", length, "edge of the cell along z", {"lz", "boxz", "boxlz"}},
        {"eps_a",
         strain,
         "axial strain of a triaxial test",
         {"epsa", "ea", "epsilona", "axialstrain", "epsaxial", "epsilonaxial", "strainaxial"}},
        {"eps_v",
         strain,
         "volumetric strain",
         {"epsv", "ev", "epsilonv", "volumetricstrain", "epsvol", "epsilonvol", "strainvol"}},
        {"nu",
         number,
         "volume fraction",
         {"nu", "phi", "volumefraction", "solidfraction", "packingfraction", "solidvolumefraction"}},
        {"void_ratio", number, "void ratio e, nu = 1/(1 + e)", {"voidratio"}},
        {"void_ratio", number, "void ratio e, nu = 1/(1 + e)", {"e"}, true},
        {"porosity", number, "porosity n, nu = 1 - n", {"porosity"}},
        {"porosity", number, "porosity n, nu = 1 - n", {"n"}, true},
        {"p", stress, "mean stress, tr sigma/3", {"pressure", "meanstress", "meanpressure"}},
        {"p", stress, "mean stress, tr sigma/3", {"p"}, true},
        {"q",
         stress,
         "deviatoric stress of a triaxial test, axial minus radial",
         {"deviatoricstress", "deviatorstress"}},
        {"q", stress, "deviatoric stress of a triaxial test, axial minus radial", {"q"}, true},
        {"P_star", number, "mean stress over k/(2<r>)", {"pstar"}},
        {"C_star", number, "corrected coordination number M4/N4", {"cstar"}},
        {"C", number, "modified coordination number M4/N = (1 - phi_r) C*", {}},
        {"rattler_fraction",
         number,
         "fraction of particles with fewer than 4 contacts",
         {"rattlerfraction", "rattlers", "phir"}},
        {"mean_overlap", number, "mean overlap of contacts over the mean radius", {"meanoverlap"}},
        {"C_r", number, "simple coordination number M/N", {}},
        {"inertial_number", number, "inertial number", {"inertialnumber"}}};
    add_tensor("strain", strain, "strain", {"strain", "eps", "epsilon", "e"}, list);
    add_tensor("stress", stress, "stress", {"stress", "sigma", "sig", "s"}, list);
    add_tensor("fabric", number, "fabric tensor, its trace of the order of nu C", {"fabric", "fab", "f"}, list);
    return list;
  }();
  return all;
}

const Quantity* find_quantity(const std::string& name) {
  const auto found = std::ranges::find(quantities(), name, &Quantity::name);
  return found == quantities().end() ? nullptr : &*found;
}

Title parted(const std::string& title) {
  const auto part = [&](std::size_t begin, std::size_t end) {
    return std::string(trimmed(std::string_view(title).substr(begin, end - begin)));
  };
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}}) {
    const auto at = title.rfind(open);
    if (at != std::string::npos && at > 0 && title.back() == close)
      return {part(0, at), part(at + 1, title.size() - 1)};
  }
  for (const char separator : {'_', '/', ' '}) {
    const auto at = title.rfind(separator);
    if (at == std::string::npos || at == 0) continue;
    const std::string word = title.substr(at + 1);  // "_m" and "_s" may mean anything
    const bool unit =
        word == "%" || (word.size() > 1 && std::ranges::any_of(kUnits, [&](const Unit& u) { return word == u.name; }));
    if (unit) return {part(0, at), word};
  }
  return {part(0, title.size()), std::nullopt};
}

const Quantity* guessed(const std::string& name) {
  const std::string word = plain(name);
  for (const Quantity& quantity : quantities()) {
    if (name == quantity.name) return &quantity;
    for (const std::string& alias : quantity.aliases) {
      if (quantity.exact ? name == alias || name == alias + "'" : word == alias) return &quantity;
    }
  }
  return nullptr;
}

std::optional<double> factor_of(UnitKind kind, const std::string& unit) {
  for (const Unit& known : kUnits) {
    if (known.kind == kind && unit == known.name) return known.factor;
  }
  return std::nullopt;
}

std::string known_units(UnitKind kind) {
  std::string list;
  for (const Unit& known : kUnits) {
    if (known.kind == kind && *known.name != '\0') list.append(list.empty() ? "" : ", ").append(known.name);
  }
  return list;
}

}  // namespace grainlaw::chain
