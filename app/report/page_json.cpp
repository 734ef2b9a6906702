#include <cmath>

#include "app/report/page.hpp"

namespace grainlaw::app::report {
namespace {

OrderedJson json_numbers(const std::vector<double>& values) {
  OrderedJson list = OrderedJson::array();
  for (const double value : values) list.push_back(number_or_null(std::isfinite(value) ? value : kUndefined));
  return list;
}

/// "quantity [unit]" in its two parts; the unit is empty where there is none, and of a ratio.
OrderedJson labelled(const Text& label) {
  const std::string words = to_plain(label);
  const std::size_t open = words.rfind(" ["), close = words.rfind(']');
  if (open == std::string::npos || close != words.size() - 1) return {{"name", words}, {"unit", ""}};
  const std::string unit = words.substr(open + 2, close - open - 2);
  return {{"name", words.substr(0, open)}, {"unit", unit == "–" ? "" : unit}};
}

OrderedJson json_of(const Paragraph& paragraph) { return {{"paragraph", to_plain(paragraph.text)}}; }
OrderedJson json_of(const Items& items) { return {{"items", items.lines}}; }

OrderedJson json_of(const Tiles& tiles) {
  OrderedJson list = OrderedJson::array();
  for (const Tile& tile : tiles.tiles) {
    list.push_back({{"name", to_plain(tile.label)}, {"text", to_plain(tile.value)}, {"note", tile.note}});
    if (std::isfinite(tile.number)) list.back()["value"] = tile.number;
  }
  return {{"caption", tiles.caption}, {"tiles", list}};
}

OrderedJson json_of(const Cell& cell) {
  OrderedJson json{{"text", to_plain(cell.text)}};
  if (std::isfinite(cell.value)) json["value"] = cell.value;
  if (cell.bar) json["interval"] = json_numbers({cell.bar->lower, cell.bar->upper});
  return json;
}

OrderedJson json_of(const Table& table) {
  OrderedJson columns = OrderedJson::array(), rows = OrderedJson::array();
  for (const TableColumn& column : table.columns) columns.push_back(labelled(column.heading));
  for (const auto& row : table.rows) {
    OrderedJson& cells = rows.emplace_back(OrderedJson::array());
    for (const Cell& cell : row) cells.push_back(json_of(cell));
  }
  OrderedJson json{{"table", table.caption}, {"source", table.source}, {"columns", columns}, {"rows", rows}};
  if (!table.notes.empty()) json["notes"] = table.notes;
  return json;
}

OrderedJson json_of(const Series& series) {
  OrderedJson json{{"label", to_plain(series.label)}, {"x", json_numbers(series.x)}, {"y", json_numbers(series.y)}};
  if (!series.y_error.empty()) json["standard_error"] = json_numbers(series.y_error);
  OrderedJson bands = OrderedJson::array();
  for (const auto& band : series.bands) bands.push_back(json_numbers(band));
  if (!bands.empty()) json["bands"] = std::move(bands);
  if (!series.toggle.empty()) json["toggle"] = series.toggle;
  return json;
}

OrderedJson json_of(const Figure& figure) {
  OrderedJson panels = OrderedJson::array();
  for (const Panel& panel : figure.panels) {
    OrderedJson series = OrderedJson::array();
    for (const Series& drawn : panel.series) series.push_back(json_of(drawn));
    panels.push_back({{"title", to_plain(panel.title)},
                      {"x", labelled(panel.x.label)},
                      {"y", labelled(panel.y.label)},
                      {"series", series}});
  }
  return {{"figure", figure.id},       {"title", figure.title},     {"caption", to_plain(figure.caption)},
          {"sources", figure.sources}, {"command", figure.command}, {"panels", panels}};
}

/// Its numbers are those of its source.
OrderedJson json_of(const Drawing& drawing) {
  return {{"drawing", drawing.id},
          {"title", drawing.title},
          {"caption", to_plain(drawing.caption)},
          {"sources", drawing.sources}};
}

OrderedJson json_of(const std::vector<Block>& blocks) {
  OrderedJson list = OrderedJson::array();
  for (const Block& block : blocks) {
    for (const BlockContent& content : block.contents)
      list.push_back(std::visit([](const auto& value) { return json_of(value); }, content));
  }
  return list;
}

}  // namespace

OrderedJson page_json(const Page& page) {
  OrderedJson sections = OrderedJson::array();
  for (const Section& section : page.sections)
    sections.push_back({{"id", section.id}, {"heading", section.heading}, {"contents", json_of(section.blocks)}});
  return {{"title", page.title}, {"lead", json_of(page.lead)}, {"sections", sections}};
}

}  // namespace grainlaw::app::report
