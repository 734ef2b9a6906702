#pragma once
// Structs as JSON by the table of their fields (model/vocabulary/fields.hpp): numbers (null where NaN), words, names of enums,
// arrays, and structs that have tables themselves. Fields that are free have no key, those that are fixed one in runs alone.

#include <string>
#include <vector>

#include "model/files/json_document.hpp"
#include "model/files/whole_number.hpp"
#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw {

template <HasFields T>
OrderedJson fields_to_json(const T& object, bool with_fixed = false);

/// Takes the fields out of `json`; throws an exception of the JSON library for a key that is missing.
template <HasFields T>
void read_fields(const Json& json, T& object);

/// Likewise those whose keys are present; the others stay.
template <HasFields T>
void read_given_fields(const Json& json, T& object);

/// The fields in which `object` is not as it is by default.
template <HasFields T>
OrderedJson changed_fields(const T& object) {
  OrderedJson json = fields_to_json(object);
  const OrderedJson usual = fields_to_json(T{});
  for (const auto& field : usual.items()) {
    if (json[field.key()] == field.value()) json.erase(field.key());
  }
  return json;
}

/// Lists of them as arrays.
template <HasFields T>
OrderedJson fields_to_json(const std::vector<T>& list);
template <HasFields T>
void read_fields(const Json& json, std::vector<T>& list);

namespace detail {

template <class Value>
OrderedJson to_json(const Value& value) {
  if constexpr (HasFields<Value>)
    return fields_to_json(value);
  else if constexpr (NamedEnum<Value>)
    return to_string(value);
  else if constexpr (std::is_same_v<Value, double>)
    return number_or_null(value);
  else if constexpr (requires { value.has_value(); })
    return value ? to_json(*value) : OrderedJson(nullptr);
  else if constexpr (requires { value.begin(); } && !std::is_same_v<Value, std::string>) {
    OrderedJson array = OrderedJson::array();
    for (const auto& each : value) array.push_back(to_json(each));
    return array;
  } else
    return value;
}

template <class Value>
void take(const Json& json, const char* name, Value& value) {
  if constexpr (HasFields<Value>) {
    read_fields(json, value);
  } else if constexpr (NamedEnum<Value>) {
    value = value_of<Value>(json.get<std::string>(), name);
  } else if constexpr (std::is_same_v<Value, double>) {
    value = number_or_nan(json);
  } else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
    value = whole_number<Value>(json);
  } else if constexpr (requires { value.has_value(); }) {
    value.reset();
    if (!json.is_null()) take(json, name, value.emplace());
  } else if constexpr (requires { value.emplace_back(); } && !std::is_same_v<Value, std::string>) {
    value.clear();
    for (const Json& each : json) take(each, name, value.emplace_back());
  } else {
    json.get_to(value);
  }
}

template <class T>
void read(const Json& json, T& object, bool all) {
  for_each_field<T>([&](const auto& field) {
    auto& value = std::invoke(field.access, object);
    if constexpr (HasFields<std::remove_cvref_t<decltype(value)>>) {
      if (*field.name == '\0') return read(json, value, all);
    }
    if (field.rule == Rule::fixed || field.rule == Rule::free || (!all && !json.contains(field.name))) return;
    take(json.at(field.name), field.name, value);
  });
}

}  // namespace detail

template <HasFields T>
OrderedJson fields_to_json(const T& object, bool with_fixed) {
  OrderedJson json = OrderedJson::object();
  for_each_field<T>([&](const auto& field) {
    const auto& value = std::invoke(field.access, object);
    if constexpr (HasFields<std::remove_cvref_t<decltype(value)>>) {
      if (*field.name == '\0') return json.update(fields_to_json(value, with_fixed));
    }
    if (field.rule == Rule::free || (field.rule == Rule::fixed && !with_fixed)) return;
    json[field.name] = detail::to_json(value);
  });
  return json;
}

template <HasFields T>
void read_fields(const Json& json, T& object) {
  detail::read(json, object, true);
}
template <HasFields T>
void read_given_fields(const Json& json, T& object) {
  detail::read(json, object, false);
}

template <HasFields T>
OrderedJson fields_to_json(const std::vector<T>& list) {
  return detail::to_json(list);
}
template <HasFields T>
void read_fields(const Json& json, std::vector<T>& list) {
  detail::take(json, "", list);
}

}  // namespace grainlaw
