#pragma once
// The page as plain data, and as one HTML document that needs nothing from outside and no script to be read.

#include <string>
#include <variant>
#include <vector>

#include "app/report/figure.hpp"
#include "app/report/table.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::app::report {

enum class Tone { plain, good, fair, poor };

struct Paragraph {
  Text text;
  Tone tone = Tone::plain;  ///< others are set apart, in a colour
};

/// The few numbers that are read first, side by side.
struct Tile {
  Text label, value;
  std::string note;            ///< small, beneath
  double number = kUndefined;  ///< before rounding, in the unit of the value
};
struct Tiles {
  std::string caption;  ///< what they are, for all
  std::vector<Tile> tiles;
};

struct Items {
  std::vector<std::string> lines;
  std::vector<std::string> sections = {};  ///< of each line the id that it links to, empty: none; may be none at all
};

using BlockContent = std::variant<Paragraph, Tiles, Items, Table, Figure, Drawing>;

/// What stands together; with a summary it is folded under these words.
struct Block {
  std::vector<BlockContent> contents;
  std::string summary = {};
};

struct Section {
  std::string id;  ///< letters, digits and '-'
  std::string heading;
  std::vector<Block> blocks;
};

struct Page {
  std::string title;
  std::vector<Block> lead;  ///< before the contents
  std::vector<Section> sections;
};

/// A figure comes with legend, caption, sources, count of points not drawn, and its numbers for the page's one script, which the
/// page's security policy names by its digest; nothing else may run.
std::string page_html(const Page& page);

/// All that stands on the page, with every number before rounding: of tables by rows with the columns' units, of figures by
/// panels and series.
OrderedJson page_json(const Page& page);

/// The style sheet: light, dark and print; and that of tiles, heat maps and bars, which no figure needs.
const char* page_style();
const char* block_style();

}  // namespace grainlaw::app::report
