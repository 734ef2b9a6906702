#pragma once
// Names of an enum's values in files, options and messages, written once. Beside the enum stands its table,
//   constexpr auto names_of(Branch) { return std::array{"loading", "unloading"}; }
// one name for each value in the order of declaration, from 0 on; what is below follows from it.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "model/vocabulary/error.hpp"

namespace grainlaw {

template <class E>
concept NamedEnum = std::is_enum_v<E> && requires {
  names_of(E{});
};

/// All values of the enum, in the order of declaration.
template <NamedEnum E>
inline constexpr auto kValues = [] {
  std::array<E, names_of(E{}).size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<E>(i);
  return values;
}();

template <NamedEnum E>
std::string to_string(E value) {
  return names_of(value).at(static_cast<std::size_t>(value));
}

/// The value of a name, if there is one.
template <NamedEnum E>
std::optional<E> find_value(std::string_view name) {
  for (const E value : kValues<E>) {
    if (name == names_of(value)[static_cast<std::size_t>(value)]) return value;
  }
  return std::nullopt;
}

/// "a, b, c", for messages.
template <NamedEnum E>
std::string list_of_names() {
  std::string list;
  for (const char* name : names_of(E{})) list.append(list.empty() ? "" : ", ").append(name);
  return list;
}

/// The value of a name. Throws InvalidInput "WHAT: 'NAME' is none; give one of a, b, c".
template <NamedEnum E>
E value_of(std::string_view name, const char* what) {
  if (const auto value = find_value<E>(name)) return *value;
  throw InvalidInput(std::string(what) + ": '" + std::string(name) + "' is none; give one of " + list_of_names<E>());
}

}  // namespace grainlaw
