#include "app/report/page.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

#include "app/report/svg_figure.hpp"

namespace grainlaw::app::report {
namespace {

constexpr const char* kTemplate = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'"/>
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
<h2 id="{{id}}-heading">{{{heading}}}</h2>
{{#blocks}}
{{{html}}}
{{/blocks}}
</section>
{{/sections}}
</main>
</body>
</html>
)";

using kainjow::mustache::data;

std::string file_list(const std::vector<std::string>& files) {
  std::string html;
  for (const std::string& file : files) {
    if (!html.empty()) html += ", ";
    html += "<code>" + to_html(plain(file)) + "</code>";
  }
  return html;
}

/// `characters` of its text; 0 in a heading.
const char* cell_class(Content content, std::size_t characters) {
  if (content == Content::words) return characters > 30 ? " class=\"long\"" : "";
  return content == Content::symbol ? " class=\"symbol\"" : " class=\"number\"";
}

/// JSON has no NaN: what is undefined becomes null.
nlohmann::json number_list(const std::vector<double>& values) {
  auto list = nlohmann::json::array();
  for (const double value : values) {
    if (!std::isfinite(value)) {
      list.push_back(nullptr);
      continue;
    }
    // Six digits are more than a figure shows; the files have them all.
    const std::string digits = fmt::format("{:.6g}", value);
    double rounded = value;
    std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
    list.push_back(rounded);
  }
  return list;
}

/// The figure's numbers, safe inside a <script> element: no '<', no line separator of JavaScript.
std::string figure_data(const Figure& figure) {
  nlohmann::ordered_json document;
  document["figure"] = figure.id;
  document["panels"] = nlohmann::json::array();
  for (const Panel& panel : figure.panels) {
    nlohmann::ordered_json entry{{"title", to_plain(panel.title)},
                                 {"x", to_plain(panel.x.label)},
                                 {"y", to_plain(panel.y.label)},
                                 {"series", nlohmann::json::array()}};
    for (const Series& series : panel.series) {
      entry["series"].push_back(
          {{"label", to_plain(series.label)}, {"x", number_list(series.x)}, {"y", number_list(series.y)}});
    }
    document["panels"].push_back(entry);
  }
  std::string safe;
  for (const char c : document.dump(-1, ' ', /*ensure_ascii=*/true))
    safe += c == '<' || c == '>' || c == '&' ? fmt::format("\\u{:04x}", static_cast<int>(c)) : std::string(1, c);
  return safe;
}

std::string html_of(const Paragraph& paragraph) { return "<p>" + to_html(paragraph.text) + "</p>"; }

std::string html_of(const Warning& warning) {
  std::string html = "<p class=\"warning\">" + to_html(plain(warning.text));
  if (!warning.section.empty())
    html += "<a href=\"#" + warning.section + "\">" + to_html(plain(warning.link)) + "</a>.";
  return html + "</p>";
}

std::string html_of(const Items& items) {
  std::string html = "<ul>\n";
  for (const std::string& line : items.lines) html += "<li>" + to_html(plain(line)) + "</li>\n";
  return html + "</ul>";
}

std::string html_of(const Table& table) {
  std::string html = "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"" +
                     to_html(plain(table.caption)) + "\">\n<table>\n<caption>" + to_html(plain(table.caption));
  if (!table.source.empty()) html += " <span class=\"source\">From " + file_list({table.source}) + "</span>";
  html += "</caption>\n<thead><tr>";
  for (const TableColumn& column : table.columns) {
    html += fmt::format("<th scope=\"col\"{}>{}</th>", cell_class(column.content, 0), to_html(column.heading));
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size() && i < table.columns.size(); ++i) {
      const char* const tag = i == 0 ? "th" : "td";
      html +=
          fmt::format("<{}{}{}>{}</{}>", tag, i == 0 ? " scope=\"row\"" : "",
                      cell_class(table.columns[i].content, character_count(row[i].text)), to_html(row[i].text), tag);
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n</div>";
}

std::string html_of(const Figure& figure) {
  const RenderedFigure rendered = render_svg(figure);
  std::string html = fmt::format("<figure id=\"{}\">\n<div class=\"scroll\">{}</div>\n<figcaption><b>{}.</b> {}",
                                 figure.id, rendered.svg, to_html(plain(figure.title)), to_html(figure.caption));
  if (rendered.undefined_points > 0) {
    html += fmt::format(" <span class=\"source\">{} undefined points are not drawn.</span>", rendered.undefined_points);
  }
  if (rendered.outside_points > 0) {
    html += fmt::format(" <span class=\"source\">{} points lie outside the axes.</span>", rendered.outside_points);
  }
  html += " <span class=\"source\">Drawn from " + file_list(figure.sources) + ".</span></figcaption>\n";
  html += fmt::format("<script type=\"application/json\" id=\"{}-data\">{}</script>\n</figure>", figure.id,
                      figure_data(figure));
  return html;
}

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
  root.set("style", page_style());
  root.set("lead", html_list(page.lead));
  root.set("sections", sections);
  kainjow::mustache::mustache view{kTemplate};
  return view.render(root);
}

}  // namespace grainlaw::app::report
