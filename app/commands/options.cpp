#include "app/commands/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "model/files/number_text.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/nearest_word.hpp"

namespace grainlaw::app {
namespace {

constexpr std::size_t kMostSeeds = 1000;  // as in SPEC, and so the largest:
constexpr std::uint64_t kLargestSeed = std::uint64_t{1} << 53;

}  // namespace

std::string choice_type(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, "|")); }

std::size_t chosen(const std::string& option, const std::string& text, const std::vector<std::string>& words) {
  const auto at = std::find(words.begin(), words.end(), text);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  const std::string meant = nearest_word(text, words);
  throw CLI::ValidationError(option, fmt::format("got '{}'; {}", one_line(text, 60),
                                                 meant.empty() ? fmt::format("give {}", fmt::join(words, " or "))
                                                               : fmt::format("did you mean {}?", meant)));
}

CLI::Validator between(double least, double most) {
  const std::string range = fmt::format("{:g} to {:g}", least, most);
  const auto check = [least, most, range](const std::string& text) -> std::string {
    const auto number = number_of<double>(text);
    const bool octal = text.size() > 1 && text[0] == '0' && text[1] != '.' && text[1] != 'e';
    if (number && *number >= least && *number <= most && !octal) return "";
    return fmt::format("got '{}'; give a number, {}", one_line(text, 60), range);
  };
  return {check, range, range};
}

CLI::Validator not_empty() {
  return {[](const std::string& text) -> std::string {
            return text.empty() ? "is empty; is a variable of the shell not set?" : "";
          },
          ""};
}

std::vector<std::uint64_t> seeds_of(const std::string& option, const std::string& text) {
  const auto refuse = [&](const std::string& why) {
    throw CLI::ValidationError(option, fmt::format("got '{}'; {}", one_line(text, 60), why));
  };
  std::vector<std::uint64_t> seeds;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t dash = part.find('-');
    const auto first = number_of<std::uint64_t>(part.substr(0, dash));
    const auto last = dash == std::string::npos ? first : number_of<std::uint64_t>(part.substr(dash + 1));
    if (!first || !last || *last < *first) refuse("give seeds and ranges of them, e.g. 201-205 or 1,3,7-9");
    if (*last > kLargestSeed) refuse(fmt::format("give seeds up to {}", kLargestSeed));
    if (*last - *first >= kMostSeeds - seeds.size()) refuse(fmt::format("give at most {} seeds", kMostSeeds));
    for (std::uint64_t more = 0; more <= *last - *first; ++more) seeds.push_back(*first + more);
  }
  return seeds;
}

CLI::Option* add_seeds(CLI::App& command, const std::string& name, std::vector<std::uint64_t>& seeds,
                       const std::string& description) {
  const auto add = [name, &seeds](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      for (const std::uint64_t seed : seeds_of(name, text)) seeds.push_back(seed);
    }
  };
  return command.add_option_function<std::vector<std::string>>(name, add, description)->type_name("SEEDS");
}

}  // namespace grainlaw::app
