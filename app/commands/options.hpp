#pragma once
// Options whose values are words, ranges of numbers or seeds: declared so that help, completion and refusals name the choices.
// What follows an option is said by its type name: FILE, DIR, "one|other", or any other word for free text.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "model/vocabulary/enum_names.hpp"

namespace grainlaw::app {

/// "one|other", the type name of a choice.
std::string choice_type(const std::vector<std::string>& words);

/// Index of `text` in `words`. Throws CLI::ValidationError that names the option, the words and the one that may be meant.
std::size_t chosen(const std::string& option, const std::string& text, const std::vector<std::string>& words);

/// Checks that a number lies in [least, most] and begins with no idle zero, which would make it octal; its description is "LEAST to MOST".
CLI::Validator between(double least, double most);

/// Refuses an empty word, as a variable of the shell leaves it that is not set.
CLI::Validator not_empty();

/// "201-205" or "1,3,7-9" as seeds, in that order. Throws CLI::ValidationError for what is neither, and for more than 1000.
std::vector<std::uint64_t> seeds_of(const std::string& option, const std::string& text);

/// An option whose value is one of the names of E; `value` is E or std::optional<E>.
template <NamedEnum E, class Value>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Value& value, const std::string& description) {
  const auto names = names_of(E{});
  const std::vector<std::string> words(names.begin(), names.end());
  const auto set = [name, words, &value](const std::string& text) {
    value = static_cast<E>(chosen(name, text, words));
  };
  return command.add_option_function<std::string>(name, set, description)->type_name(choice_type(words));
}

/// An option with a value, of which `type` says what it is.
template <class Value>
CLI::Option* add_value(CLI::App& command, const std::string& name, Value& value, const std::string& type,
                       const std::string& description) {
  return command.add_option(name, value, description)->type_name(type);
}

/// An option that takes a number in [least, most].
template <class Value>
CLI::Option* add_number(CLI::App& command, const std::string& name, Value& value, double least, double most,
                        const std::string& type, const std::string& description) {
  return add_value(command, name, value, type, description)->check(between(least, most));
}

/// An option that takes seeds and ranges of seeds.
CLI::Option* add_seeds(CLI::App& command, const std::string& name, std::vector<std::uint64_t>& seeds,
                       const std::string& description);

}  // namespace grainlaw::app
