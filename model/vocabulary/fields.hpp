#pragma once
// The fields of a struct, told once in a table beside it:
//   constexpr auto fields_of(std::type_identity<Material>) {
//     return std::tuple{Field{&Material::density, "density", "kg/m^3", "rho", "mass density of the spheres"}, ...};
//   }
// From it follow the columns of a series and the numbers of a checkpoint, the keys of JSON files and of the run store, and what
// docs/formats.md says of them. Plain compile-time data: a new member is one line here, and what writes and reads follows.

#include <cstddef>
#include <functional>
#include <tuple>
#include <type_traits>
#include <utility>

namespace grainlaw {

/// What else writers and readers must know of a field.
enum class Rule {
  plain,
  needed,         ///< a file has it, perhaps undefined
  needed_number,  ///< a file has it, defined in every row
  fixed,          ///< results depend on it, but it is no key of a file: the run store alone knows it
  free,           ///< results do not depend on it: in no file, in no key
};

template <class Access>
struct Field {
  Access access;             ///< pointer to the member, or a lambda from the struct to a reference into it
  const char* name;          ///< key and column; empty: the fields of this member stand in its place
  const char* unit = "";     ///< empty: dimensionless
  const char* symbol = "";   ///< the paper's
  const char* meaning = "";  ///< one line
  Rule rule = Rule::plain;
};
template <class Access, class... Rest>
Field(Access, Rest...) -> Field<Access>;

/// A struct with a table.
template <class T>
concept HasFields = requires {
  fields_of(std::type_identity<T>{});
};

/// Calls visit(field) for each field of the table of T, in its order.
template <HasFields T, class Visit>
constexpr void for_each_field(Visit&& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, fields_of(std::type_identity<T>{}));
}

/// What a field of T holds.
template <class T, class Access>
using ValueOf = std::remove_cvref_t<std::invoke_result_t<Access, T&>>;

namespace detail {
struct Anything {
  template <class Value>
  operator Value() const;
};
template <class T, class... Given>
consteval std::size_t member_count() {
  if constexpr (requires { T{Given{}..., Anything{}}; })
    return member_count<T, Given..., Anything>();
  else
    return sizeof...(Given);
}
}  // namespace detail

/// Whether the table of T has as many fields as T has members: to be asserted beside the table, so that no member is forgotten.
template <HasFields T>
consteval bool tells_every_member() {
  return detail::member_count<T>() == std::tuple_size_v<decltype(fields_of(std::type_identity<T>{}))>;
}

}  // namespace grainlaw
