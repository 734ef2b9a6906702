#include "tests/fuzz/mutation.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "model/files/csv_table.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::fuzz {
namespace {

std::size_t below(std::size_t n, Chance& chance) { return n == 0 ? 0 : chance() % n; }

template <class List>
auto& any_of(List& list, Chance& chance) {
  return list[below(std::size(list), chance)];
}

constexpr std::array kNumbers{0.0,
                              -0.0,
                              1.0,
                              -1.0,
                              2.0,
                              0.5,
                              0.72,
                              1e-9,
                              1e9,
                              1e18,
                              1e19,
                              -1e19,
                              1e150,
                              -1e300,
                              1e308,
                              5e-324,
                              2.2e-308,
                              0.9,
                              1e-150,
                              1001.0,
                              2147483648.0,
                              9007199254740993.0,
                              18446744073709551615.0};

Json any_value(Chance& chance) {
  static const std::array<Json, 16> kValues{nullptr,
                                            true,
                                            false,
                                            "",
                                            "x",
                                            "../x",
                                            "all",
                                            "ISO",
                                            "a\nb",
                                            "\u009b\u202e",
                                            std::string(300, 'n'),
                                            Json::array(),
                                            Json::object(),
                                            std::numeric_limits<std::int64_t>::min(),
                                            std::numeric_limits<std::uint64_t>::max(),
                                            -1};
  return below(2, chance) == 0 ? any_of(kValues, chance) : Json(any_of(kNumbers, chance));
}

/// Every value of the document with whether it may be removed: parents before children.
void collect(Json& node, std::vector<Json*>& nodes) {
  nodes.push_back(&node);
  if (node.is_structured()) {
    for (Json& child : node) collect(child, nodes);
  }
}

void change_number(Json& node, Chance& chance) {
  const double value = node.get<double>();
  const std::array<double, 8> others{-value,
                                     value * 10,
                                     value / 10,
                                     value + 1,
                                     value - 1,
                                     value * 1e6,
                                     std::nextafter(value, 1e300),
                                     any_of(kNumbers, chance)};
  if (const double other = any_of(others, chance); std::isfinite(other)) node = other;
  if (below(2, chance) == 0 && std::abs(node.get<double>()) < 1e15) node = node.get<std::int64_t>();
}

void change_members(Json& node, Chance& chance) {
  const auto at = [&](std::size_t i) { return std::next(node.begin(), static_cast<std::ptrdiff_t>(i)); };
  const auto one = at(below(node.size(), chance)), other = at(below(node.size(), chance));
  switch (below(4, chance)) {
    case 0:
      node.erase(one);
      return;
    case 1:
      std::swap(*one, *other);
      return;
    case 2:
      if (node.is_object()) {
        Json value = *one;
        node[other.key() + (below(2, chance) == 0 ? "" : "x")] = std::move(value);
      } else {
        const Json value = *one;
        node.insert(node.end(), below(8, chance) == 0 ? 200 : 1, value);
      }
      return;
    default:
      *one = any_value(chance);
  }
}

bool mutate_json(std::string& text, Chance& chance) {
  Json document = Json::parse(text, nullptr, false, true);
  if (document.is_discarded()) return false;
  for (std::size_t changes = 1 + below(3, chance); changes > 0; --changes) {
    std::vector<Json*> nodes;
    collect(document, nodes);
    Json& node = *any_of(nodes, chance);
    if (node.is_structured() && !node.empty())
      change_members(node, chance);
    else if (node.is_number() && below(4, chance) != 0)
      change_number(node, chance);
    else if (below(4, chance) == 0)
      node = Json(*any_of(nodes, chance));
    else
      node = any_value(chance);
  }
  text = document.dump(below(2, chance) == 0 ? -1 : 1, ' ', false, Json::error_handler_t::replace);
  return true;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::string joined(const std::vector<std::string>& parts, char separator) {
  std::string text;
  for (const std::string& part : parts)
    text.append(&part == &parts.front() ? "" : std::string(1, separator)).append(part);
  return text;
}

void change_field(std::string& field, Chance& chance) {
  static const std::array<std::string, 12> kFields{"",      "nan", "inf", "-0",  "1e999", "0x1p3",
                                                   "\"1\"", " 1 ", "1,5", "1\r", "+1",    std::string(2000, '9')};
  const auto digit = field.find_first_of("123456789");
  if (below(4, chance) == 0)
    field = any_of(kFields, chance);
  else if (below(2, chance) == 0 || digit == std::string::npos)
    field = csv_number(any_of(kNumbers, chance));
  else
    field[digit] = static_cast<char>('0' + below(10, chance));
}

bool mutate_csv(std::string& text, Chance& chance) {
  const char separator = text.find(',') == std::string::npos ? ' ' : ',';
  std::vector<std::string> lines = split(text, '\n');
  std::string& line = any_of(lines, chance);
  std::vector<std::string> fields = split(line, separator);
  switch (below(8, chance)) {
    case 0:
      std::swap(line, any_of(lines, chance));
      break;
    case 1:
      lines.erase(lines.begin() + (&line - lines.data()));
      break;
    case 2:
      lines.push_back(std::string(line));
      break;
    case 3: {  // a column goes
      const std::size_t column = below(fields.size(), chance);
      for (std::string& each : lines) {
        std::vector<std::string> rest = split(each, separator);
        if (column < rest.size()) rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(column));
        each = joined(rest, separator);
      }
      break;
    }
    case 4:
      std::swap(any_of(fields, chance), any_of(fields, chance));
      line = joined(fields, separator);
      break;
    default:
      change_field(any_of(fields, chance), chance);
      line = joined(fields, separator);
  }
  text = joined(lines, '\n');
  return true;
}

/// The header as JSON with its length put right, or one of the numbers.
bool mutate_sealed(std::string& text, Chance& chance) {
  constexpr std::size_t kLength = 12, kPrefix = 16;
  if (text.size() < kPrefix) return false;
  std::size_t length = 0;
  for (std::size_t i = 0; i < 4; ++i)
    length |= static_cast<std::size_t>(static_cast<unsigned char>(text[kLength + i])) << (8 * i);
  if (length > text.size() - kPrefix) return false;
  const std::size_t begin = kPrefix + length, words = (text.size() - begin) / 8;
  if (words > 0 && below(2, chance) == 0) {
    const std::size_t at = begin + 8 * below(words, chance);
    const std::array<std::uint64_t, 6> whole{0, 1, 2, 1u << 31, std::uint64_t{1} << 63, ~std::uint64_t{0}};
    const std::uint64_t bits =
        below(2, chance) == 0 ? any_of(whole, chance) : std::bit_cast<std::uint64_t>(any_of(kNumbers, chance));
    for (std::size_t i = 0; i < 8; ++i) text[at + i] = static_cast<char>(bits >> (8 * i) & 0xff);
    return true;
  }
  std::string header = text.substr(kPrefix, length);
  if (!mutate_json(header, chance)) return false;
  for (std::size_t i = 0; i < 4; ++i) text[kLength + i] = static_cast<char>(header.size() >> (8 * i) & 0xff);
  text.replace(kPrefix, length, header);
  return true;
}

}  // namespace

void mutate_bytes(std::string& text, Chance& chance) {
  static const std::array<std::string, 10> kPieces{"{",     "[",  "\"", "\\ud800", "\xff", std::string(1, '\0'),
                                                   "1e999", "//", ",",  "\n"};
  const std::size_t at = below(text.size() + 1, chance), length = std::min(below(16, chance), text.size() - at);
  switch (below(4, chance)) {
    case 0:
      text.insert(at, any_of(kPieces, chance));
      return;
    case 1:
      text.erase(at, length);
      return;
    case 2:
      text.insert(at, text.substr(at, length));
      return;
    default:
      if (at < text.size()) text[at] = static_cast<char>(chance() & 0xff);
  }
}

std::string mutated(const std::string& text, Shape shape, Chance& chance, const ByteMutation& bytes) {
  std::string other = text;
  const auto change = shape == Shape::json ? mutate_json : shape == Shape::csv ? mutate_csv : mutate_sealed;
  if (shape == Shape::binary || below(4, chance) == 0 || !change(other, chance)) bytes(other);
  return other;
}

}  // namespace grainlaw::fuzz
