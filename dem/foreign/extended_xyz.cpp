// Extended XYZ as ASE and OVITO write it: number of rows, a line of KEY=VALUE, the rows. Read of the keys: Lattice (edge
// vectors one after the other), Properties (NAME:TYPE:COLUMNS...), pbc, Time or time, Origin.

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "dem/foreign/foreign_frame.hpp"

namespace grainlaw::dem {
namespace {

class ExtendedXyz : public ForeignReader {
 public:
  explicit ExtendedXyz(const std::filesystem::path& file) : lines_(file, "give a file in extended XYZ") {}

  bool next(ForeignFrame& frame) override {
    do {
      if (!lines_.next()) {
        if (frames_ == 0) throw lines_.refusal(1, "", "the file is empty; give a file in extended XYZ");
        return false;
      }
    } while (trimmed(lines_.line()).empty());
    frame = {};
    frame.file = lines_.file();
    frame.place = fmt::format("frame {}", ++frames_);
    const std::size_t rows = row_count(lines_, lines_.line());
    if (!lines_.next()) throw lines_.refusal("", "the file ends within a frame; cut the frame off");
    take_keys(keys_of(lines_.line()), frame);
    read_rows(lines_, rows, frame.table);
    return true;
  }

 private:
  std::map<std::string, std::string> keys_of(std::string_view line) const {
    std::map<std::string, std::string> keys;
    while (!(line = trimmed(line)).empty()) {
      const std::size_t equals = std::min(line.find('='), line.size());
      const std::string key(trimmed(line.substr(0, equals)));
      line.remove_prefix(std::min(equals + 1, line.size()));
      const bool has_quotes = line.starts_with('"');
      if (has_quotes) line.remove_prefix(1);
      const std::size_t end = std::min(line.find_first_of(has_quotes ? "\"" : " \t"), line.size());
      keys[key] = line.substr(0, end);
      line.remove_prefix(std::min(end + 1, line.size()));
    }
    return keys;
  }

  std::vector<double> numbers(const std::string& key, const std::string& text, std::size_t count) const {
    std::vector<std::string_view> words;
    split_words(text, words);
    std::vector<double> values;
    for (const std::string_view word : words) values.push_back(decimal(word).value_or(NAN));
    bool sound = values.size() == count;
    for (const double value : values) sound = sound && std::isfinite(value);
    if (!sound) throw lines_.refusal("", fmt::format("{}: {} is not {} numbers", key, in_quotes(text), count));
    return values;
  }

  void take_keys(const std::map<std::string, std::string>& keys, ForeignFrame& frame) const {
    for (const auto& [key, value] : keys) {
      if (key == "Lattice") {
        frame.H = Eigen::Map<const Eigen::Matrix3d>(numbers(key, value, 9).data());  // vectors are columns of H
      } else if (key == "Origin") {
        frame.origin = Eigen::Map<const Eigen::Vector3d>(numbers(key, value, 3).data());
      } else if (key == "Time" || key == "time") {
        frame.time = numbers(key, value, 1)[0];
      } else if (key == "pbc" && value.find_first_of("Ff0") != std::string::npos) {
        throw lines_.refusal("", fmt::format("pbc: {}: averages need a periodic cell, \"T T T\"", in_quotes(value)));
      } else if (key == "Properties") {
        take_properties(value, frame.table.columns);
      }
    }
    if (frame.table.columns.empty())
      throw lines_.refusal("", "misses Properties=; plain XYZ has no radii, write extended XYZ with pos and radius");
  }

  void take_properties(const std::string& text, std::vector<std::string>& columns) const {
    std::vector<std::string> parts{""};
    for (const char c : text) c == ':' ? parts.emplace_back() : (parts.back() += c, parts.back());
    const auto refuse = [&] { return lines_.refusal("", "Properties: must be NAME:TYPE:COLUMNS, repeated"); };
    if (parts.size() % 3 != 0) throw refuse();
    for (std::size_t i = 0; i < parts.size(); i += 3) {
      const auto components = number_of<std::int64_t>(parts[i + 2]);
      if (!components || *components < 1 || *components > 100) throw refuse();
      for (std::string& title : component_titles(parts[i], static_cast<std::size_t>(*components)))
        columns.push_back(std::move(title));
    }
  }

  TextFile lines_;
  std::size_t frames_ = 0;
};

}  // namespace

std::unique_ptr<ForeignReader> read_extended_xyz(const std::filesystem::path& file) {
  return std::make_unique<ExtendedXyz>(file);
}

}  // namespace grainlaw::dem
