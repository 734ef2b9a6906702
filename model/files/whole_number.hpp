#pragma once
// Whole numbers out of JSON, checked.

#include <concepts>
#include <utility>

#include "model/files/json_document.hpp"

namespace grainlaw {

/// A whole number that T holds. Throws an exception of the JSON library for any other value, of which get() would make some
/// number: of -1 as of 1e300.
template <std::integral T>
T whole_number(const Json& value) {
  const bool fits = value.is_number_unsigned()
                        ? std::in_range<T>(value.get<std::uint64_t>())
                        : value.is_number_integer() && std::in_range<T>(value.get<std::int64_t>());
  if (!fits)
    throw Json::type_error::create(
        302, "must be a whole number of its range, but is " + (value.is_number() ? value.dump() : value.type_name()),
        &value);
  return value.get<T>();
}

}  // namespace grainlaw
