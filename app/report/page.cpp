#include "app/report/page.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <kainjow/mustache.hpp>
#include <page_script_text.hpp>
#include <set>
#include <sstream>

#include "app/report/page_figure.hpp"
#include "model/files/digest.hpp"

namespace grainlaw::app::report {
namespace {

constexpr const char* kTemplate = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{{{script_digest}}}'"/>
<title>{{{title}}}</title>
<style>
{{{style}}}</style>
</head>
<body>
<header>
<h1>{{{title}}}</h1>
{{#lead}}
{{{html}}}
{{/lead}}
<nav aria-label="Contents">
<ol>
{{#sections}}
<li><a href="#{{id}}">{{{heading}}}</a></li>
{{/sections}}
</ol>
</nav>
</header>
<main>
{{#sections}}
<section id="{{id}}" aria-labelledby="{{id}}-heading">
<h2 id="{{id}}-heading">{{{heading}}} <a class="anchor" href="#{{id}}" aria-label="Link to this section">#</a></h2>
{{#blocks}}
{{{html}}}
{{/blocks}}
</section>
{{/sections}}
</main>
<script>{{{script}}}</script>
</body>
</html>
)";

using kainjow::mustache::data;

/// `characters` of its text; 0 in a heading.
const char* cell_class(Content content, std::size_t characters) {
  if (content == Content::words) return characters > 30 ? " class=\"long\"" : "";
  return content == Content::symbol ? " class=\"symbol\"" : " class=\"number\"";
}

std::string html_of(const Paragraph& paragraph) {
  constexpr std::array classes{"", " class=\"verdict good\"", " class=\"verdict fair\"", " class=\"verdict poor\""};
  return fmt::format("<p{}>{}</p>", classes[static_cast<std::size_t>(paragraph.tone)], to_html(paragraph.text));
}

std::string html_of(const Tiles& tiles) {
  std::string html = "<p class=\"source\">" + to_html(plain(tiles.caption)) + "</p>\n<dl class=\"tiles\">\n";
  for (const Tile& tile : tiles.tiles)
    html += fmt::format("<div><dt>{}</dt><dd><b>{}</b> {}</dd></div>\n", to_html(tile.label), to_html(tile.value),
                        to_html(plain(tile.note)));
  return html + "</dl>";
}

std::string html_of(const Items& items) {
  std::string html = "<ul>\n";
  for (std::size_t i = 0; i < items.lines.size(); ++i) {
    const std::string section = i < items.sections.size() ? items.sections[i] : "";
    const std::string line = to_html(plain(items.lines[i]));
    html += "<li>" + (section.empty() ? line : fmt::format("<a href=\"#{}\">{}</a>", section, line)) + "</li>\n";
  }
  return html + "</ul>";
}

constexpr double kBarWidth = 200, kBarHeight = 16;  // [px]

/// Place of `value` in a bar [px]; what lies beyond the range is drawn at its end.
double bar_place(const Table& table, double value) {
  return kBarWidth * std::clamp((value - table.bar_from) / (table.bar_to - table.bar_from), 0.0, 1.0);
}

std::string html_of(const Bar& bar, const Table& table, const std::string& words) {
  const double middle = kBarHeight / 2;
  std::string html = fmt::format("<svg class=\"bar\" viewBox=\"-4 0 {} {}\" role=\"img\" aria-label=\"{}\">",
                                 kBarWidth + 8, kBarHeight, words);
  if (std::isfinite(bar.reference)) {
    const double x = bar_place(table, bar.reference);
    html += fmt::format("<path class=\"k5\" d=\"M{:.1f} 1v{}\" stroke=\"currentColor\" stroke-width=\"3\"/>", x,
                        kBarHeight - 2);
  }
  if (std::isfinite(bar.lower) && std::isfinite(bar.upper))
    html += fmt::format("<path class=\"k1\" d=\"M{:.1f} {}H{:.1f}\" stroke=\"currentColor\" stroke-width=\"2\"/>",
                        bar_place(table, bar.lower), middle, bar_place(table, bar.upper));
  if (std::isfinite(bar.value))
    html += fmt::format("<circle class=\"k1\" cx=\"{:.1f}\" cy=\"{}\" r=\"3.5\" fill=\"currentColor\"/>",
                        bar_place(table, bar.value), middle);
  return html + "</svg>";
}

/// `classes` of one cell, its number for scripts that sort, and what stands in it.
std::string html_of(const Cell& cell, const Table& table, bool first, Content content) {
  std::string words = to_html(cell.text);
  if (cell.bar) words = html_of(*cell.bar, table, escape_markup(to_plain(cell.text)));
  if (!cell.link.empty()) words = "<a href=\"#" + cell.link + "\">" + words + "</a>";
  std::string classes = cell_class(content, character_count(cell.text));
  if (cell.heat >= 0) classes = fmt::format(" class=\"number heat{}\"", cell.heat);
  const std::string value = std::isfinite(cell.value) ? fmt::format(" data-value=\"{:.9g}\"", cell.value) : "";
  return first ? fmt::format("<th scope=\"row\"{}{}>{}</th>", classes, value, words)
               : fmt::format("<td{}{}>{}</td>", classes, value, words);
}

/// Name of a class of tables with the same headings.
std::string class_of(const Table& table) {
  std::string headings;
  for (const TableColumn& column : table.columns) headings += to_plain(column.heading) + "|";
  return "h" + sha256(headings).substr(0, 8);
}

/// Characters of the longest word: headings wrap between words only.
std::size_t longest_word(const Text& heading) {
  std::size_t longest = 0;
  std::istringstream words(to_plain(heading));
  words.exceptions(std::ios::badbit);
  for (std::string word; words >> word;) longest = std::max(longest, character_count(plain(word)));
  return longest;
}

/// Whether a phone has no room for it: by its words, which may wrap after a dozen characters in cells.
bool is_wide(const Table& table) {
  constexpr std::size_t kWraps = 12, kPhone = 46;  // characters
  std::size_t width = 0;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    std::size_t longest = 0;
    for (const auto& row : table.rows) {
      if (i < row.size() && row[i].bar) return true;
      if (i < row.size()) longest = std::max(longest, character_count(row[i].text));
    }
    width += std::max(std::min(longest, kWraps), longest_word(table.columns[i].heading)) + 2;
  }
  return width > kPhone;
}

std::string html_of(const Table& table) {
  std::string html = fmt::format("<div class=\"scroll\"{} role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n",
                                 table.id.empty() ? "" : " id=\"" + table.id + "\"", to_html(plain(table.caption)));
  html += "<table class=\"" + class_of(table) + (is_wide(table) ? " cards" : "") + "\">\n<caption>" +
          to_html(plain(table.caption));
  if (!table.source.empty()) html += " <span class=\"source\">From " + code_list({table.source}) + "</span>";
  html += "</caption>\n<thead><tr>";
  for (const TableColumn& column : table.columns) {
    const std::string heading = to_html(column.heading);
    html += heading.empty() ? "<td></td>"
                            : fmt::format("<th scope=\"col\"{}>{}</th>", cell_class(column.content, 0), heading);
  }
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto& row = table.rows[r];
    html += "<tr>";
    for (std::size_t i = 0; i < row.size() && i < table.columns.size(); ++i)
      html += html_of(row[i], table, i == 0, table.columns[i].content);
    html += "</tr>\n";
    if (r < table.notes.size() && !table.notes[r].empty())
      html += fmt::format("<tr class=\"note\"><td colspan=\"{}\">{}</td></tr>\n", table.columns.size(),
                          to_html(plain(table.notes[r])));
  }
  return html + "</tbody>\n</table>\n</div>";
}

std::string html_of(const Figure& figure) { return figure_html(figure); }
std::string html_of(const Drawing& drawing) { return drawing_html(drawing); }

std::string html_of(const Block& block) {
  std::string html;
  for (const BlockContent& content : block.contents)
    html += std::visit([](const auto& value) { return html_of(value); }, content);
  if (block.summary.empty()) return html;
  return "<details>\n<summary>" + to_html(plain(block.summary)) + "</summary>\n" + html + "\n</details>";
}

data html_list(const std::vector<Block>& blocks) {
  data list{data::type::list};
  for (const Block& block : blocks) list << data{"html", html_of(block)};
  return list;
}

/// `visit` each T of the page.
template <class T, class Visit>
void each_of(const Page& page, const Visit& visit) {
  const auto in_blocks = [&](const std::vector<Block>& blocks) {
    for (const Block& block : blocks) {
      for (const BlockContent& content : block.contents) {
        if (const T* const found = std::get_if<T>(&content)) visit(*found);
      }
    }
  };
  in_blocks(page.lead);
  for (const Section& section : page.sections) in_blocks(section.blocks);
}

std::size_t most_toggles(const Page& page) {
  std::size_t most = 0;
  each_of<Figure>(page, [&](const Figure& figure) {
    std::set<std::string> toggles;
    for (const Panel& panel : figure.panels) {
      for (const Series& series : panel.series) toggles.insert(series.toggle);
    }
    most = std::max(most, toggles.size());
  });
  return most;
}

/// On a narrow screen each row of a wide table is a card, in which the headings stand before their cells: rules that say them.
std::string card_style(const Page& page) {
  std::set<std::string> done;
  std::string style = "@media (max-width: 44rem) {\n";
  each_of<Table>(page, [&](const Table& table) {
    if (!done.insert(class_of(table)).second) return;
    for (std::size_t i = 1; i < table.columns.size(); ++i) {
      std::string heading;
      for (const char c : to_plain(table.columns[i].heading))
        heading += std::string_view("\"\\<>&\n").find(c) != std::string_view::npos
                       ? fmt::format("\\{:x} ", static_cast<int>(c))
                       : std::string(1, c);
      style +=
          fmt::format(".cards.{} td:nth-child({})::before {{ content: \"{}\"; }}\n", class_of(table), i + 1, heading);
    }
  });
  return style + "}\n";
}

std::string base64(const std::string& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4, ' ');
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), reinterpret_cast<const unsigned char*>(bytes.data()),
                  static_cast<int>(bytes.size()));  // ends with a zero, as the string does
  return text;
}

}  // namespace

std::string page_html(const Page& page) {
  data sections{data::type::list};
  for (const Section& section : page.sections) {
    data entry;
    entry.set("id", section.id);
    entry.set("heading", to_html(plain(section.heading)));
    entry.set("blocks", html_list(section.blocks));
    sections << entry;
  }
  data root;
  root.set("title", to_html(plain(page.title)));
  root.set("style", page_style() + std::string(block_style()) + toggle_style(most_toggles(page)) + card_style(page));
  root.set("script", std::string(kPageScript));
  root.set("script_digest", base64(sha256_bytes(kPageScript)));
  root.set("lead", html_list(page.lead));
  root.set("sections", sections);
  kainjow::mustache::mustache view{kTemplate};
  std::string html;
  view.render(root, [&](const std::string& text) { html += text; });
  return html;
}

}  // namespace grainlaw::app::report
