// Dumps of LAMMPS, of styles custom, atom and local: per frame "ITEM: ..." lines with step, number of rows, box and titles.
//   box        pp pp pp: lo hi of each axis;   xy xz yz pp pp pp: bounds of the tilted box and its tilts
//   lo = lo_bound - min(0, tilts...), hi = hi_bound - max(0, tilts...), H = [lx xy xz; 0 ly yz; 0 0 lz]

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "dem/foreign/foreign_frame.hpp"

namespace grainlaw::dem {
namespace {

class LammpsDump : public ForeignReader {
 public:
  explicit LammpsDump(const std::filesystem::path& file) : lines_(file, "give a dump file of LAMMPS") {}

  bool next(ForeignFrame& frame) override {
    if (!lines_.next()) {
      if (lines_.number() == 0) throw lines_.refusal(1, "", "the file is empty; give a dump file of LAMMPS");
      return false;
    }
    frame = {};
    frame.file = lines_.file();
    std::optional<std::size_t> rows;
    for (;; read_line()) {
      const std::string_view line = lines_.line();
      if (!line.starts_with("ITEM: "))
        throw lines_.refusal(
            "", fmt::format("{} where an ITEM: must begin; is it a text dump of LAMMPS?", in_quotes(line)));
      const std::string_view item = trimmed(line.substr(6));
      if (item == "TIMESTEP") {
        frame.step = read_number();
        frame.place = fmt::format("step {}", frame.step);
      } else if (item == "TIME") {
        frame.time = read_number();
      } else if (item == "UNITS") {
        read_line();
      } else if (item.starts_with("NUMBER OF ")) {
        read_line();
        rows = row_count(lines_, lines_.line());
      } else if (item.starts_with("BOX BOUNDS")) {
        read_box(item.substr(10), frame);
      } else {
        if (std::isnan(frame.step) || !rows) throw lines_.refusal("", "follows neither a TIMESTEP nor a NUMBER OF ...");
        std::vector<std::string_view> words;
        split_words(item, words);
        frame.table.columns.assign(words.begin() + (words.empty() ? 0 : 1), words.end());
        if (frame.table.columns.empty())
          throw lines_.refusal("", "names no columns; write the dump with LAMMPS of 2009 or later");
        read_rows(lines_, *rows, frame.table);
        return true;
      }
    }
  }

 private:
  void read_line() {
    if (!lines_.next()) throw lines_.refusal("", "the file ends within the head of a frame; cut the frame off");
  }

  double read_number() {
    read_line();
    const auto value = decimal(trimmed(lines_.line()));
    if (!value || !std::isfinite(*value)) throw lines_.refusal("", in_quotes(lines_.line()) + " is no number");
    return *value;
  }

  void read_box(std::string_view kinds, ForeignFrame& frame) {
    std::vector<std::string_view> words;
    split_words(kinds, words);
    const bool tilted = words.size() >= 3 && words[0] == "xy" && words[1] == "xz" && words[2] == "yz";
    if (tilted) words.erase(words.begin(), words.begin() + 3);
    if (words.size() != 3)
      throw lines_.refusal("", "is no box that is known here; write 'pp pp pp' or 'xy xz yz pp pp pp'");
    for (const std::string_view word : words) {
      if (word != "pp")
        throw lines_.refusal(
            "", fmt::format("boundary {} is not periodic; averages need a box of pp pp pp", in_quotes(word)));
    }
    std::array<std::array<double, 3>, 3> bound{};
    for (auto& row : bound) {
      read_line();
      std::vector<std::string_view> numbers;
      split_words(lines_.line(), numbers);
      if (numbers.size() != (tilted ? 3u : 2u)) throw lines_.refusal("", "a bound of the box has other numbers");
      for (std::size_t c = 0; c < numbers.size(); ++c) {
        row[c] = decimal(numbers[c]).value_or(NAN);
        if (!std::isfinite(row[c])) throw lines_.refusal("", in_quotes(numbers[c]) + " is no finite number");
      }
    }
    const double xy = bound[0][2], xz = bound[1][2], yz = bound[2][2];
    const auto lo = [&](std::size_t a, std::initializer_list<double> tilts) { return bound[a][0] - std::min(tilts); };
    const auto hi = [&](std::size_t a, std::initializer_list<double> tilts) { return bound[a][1] - std::max(tilts); };
    frame.origin = {lo(0, {0, xy, xz, xy + xz}), lo(1, {0, yz}), lo(2, {0})};
    const Eigen::Vector3d upper(hi(0, {0, xy, xz, xy + xz}), hi(1, {0, yz}), hi(2, {0}));
    frame.H = Eigen::Matrix3d((upper - frame.origin).asDiagonal());
    (*frame.H)(0, 1) = xy, (*frame.H)(0, 2) = xz, (*frame.H)(1, 2) = yz;
  }

  TextFile lines_;
};

}  // namespace

std::unique_ptr<ForeignReader> read_lammps_dump(const std::filesystem::path& file) {
  return std::make_unique<LammpsDump>(file);
}

}  // namespace grainlaw::dem
