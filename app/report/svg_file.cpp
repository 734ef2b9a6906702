#include "app/report/svg_file.hpp"

#include <fmt/format.h>

#include "app/report/page.hpp"
#include "app/report/svg_figure.hpp"
#include "dem/durable_file.hpp"

namespace grainlaw::app::report {

void write_svg(const std::filesystem::path& file, const Figure& figure) {
  std::string svg = render_svg(figure).svg;
  svg.insert(svg.find('>') + 1,
             fmt::format("\n<style><![CDATA[{}svg {{ background: var(--ground); }}]]></style>", page_style()));
  dem::write_durably(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg);
}

}  // namespace grainlaw::app::report
