#pragma once
// The page around figures and tables: one HTML document that needs nothing from outside and no script to be read.

#include <string>
#include <vector>

#include "app/report/figure.hpp"
#include "app/report/table.hpp"

namespace grainlaw::app::report {

struct Section {
  std::string id;  ///< letters, digits and '-'
  std::string heading;
  std::vector<std::string> blocks;  ///< HTML made by the functions below
};

struct Page {
  std::string title;
  std::vector<std::string> lead;  ///< HTML blocks before the contents
  std::vector<Section> sections;
};

std::string paragraph_html(const Text& text);
std::string table_html(const Table& table);
/// Figure, caption, sources, count of points not drawn, and the numbers themselves as JSON for scripts to come.
std::string figure_html(const Figure& figure);

std::string page_html(const Page& page);

/// The style sheet: light, dark and print.
const char* page_style();

}  // namespace grainlaw::app::report
