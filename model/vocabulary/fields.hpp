#pragma once
// The fields of a struct, told once in a table beside it:
//   constexpr auto fields_of(std::type_identity<Material>) {
//     return std::tuple{Field{&Material::density, "density", "kg/m^3", "rho", "mass density of the spheres"}, ...};
//   }
// or, where all that is said of a field is its name: GRAINLAW_FIELDS(PathTraits, nu_min, nu_max, ...);
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

/// The table of T, each field called as its member is: of all members, or of some; 32 at most.
#define GRAINLAW_FIELDS(T, ...)         \
  GRAINLAW_SOME_FIELDS(T, __VA_ARGS__); \
  static_assert(::grainlaw::tells_every_member<T>())
#define GRAINLAW_SOME_FIELDS(T, ...)                                  \
  constexpr auto fields_of(std::type_identity<T>) {                   \
    return std::tuple{GRAINLAW_TWICE(GRAINLAW_EACH(T, __VA_ARGS__))}; \
  }                                                                   \
  static_assert(::grainlaw::HasFields<T>)
#define GRAINLAW_EACH(T, member, ...) \
  ::grainlaw::Field{&T::member, #member}, __VA_OPT__(GRAINLAW_NEXT GRAINLAW_PARENTHESES(T, __VA_ARGS__))
#define GRAINLAW_NEXT() GRAINLAW_EACH
#define GRAINLAW_PARENTHESES ()
#define GRAINLAW_TWICE(...) GRAINLAW_TWICE_2(GRAINLAW_TWICE_2(__VA_ARGS__))
#define GRAINLAW_TWICE_2(...) GRAINLAW_TWICE_4(GRAINLAW_TWICE_4(__VA_ARGS__))
#define GRAINLAW_TWICE_4(...) GRAINLAW_TWICE_8(GRAINLAW_TWICE_8(__VA_ARGS__))
#define GRAINLAW_TWICE_8(...) GRAINLAW_TWICE_16(GRAINLAW_TWICE_16(__VA_ARGS__))
#define GRAINLAW_TWICE_16(...) __VA_ARGS__
