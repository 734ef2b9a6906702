#include "app/report/svg_file.hpp"

#include <string>

#include "app/report/page.hpp"
#include "app/report/svg_figure.hpp"
#include "model/files/durable_file.hpp"

namespace grainlaw::app::report {
namespace {

/// `style` with each declaration that reads a variable preceded by one with its first value, the light page's: viewers
/// that know no variables skip the second, others the first.
std::string with_plain_colours(const std::string& style) {
  const std::string reads = "var(--";
  std::string out;
  std::size_t copied = 0;
  for (std::size_t at = style.find(reads); at != std::string::npos; at = style.find(reads, copied)) {
    const std::size_t closed = style.find(')', at), end = style.find(';', at);
    const std::size_t begin = style.find_first_not_of(' ', style.find_last_of("{;", at) + 1);
    const std::size_t name = at + reads.size();
    const std::string defined = "--" + style.substr(name, closed - name) + ": ";
    const std::size_t value = style.find(defined) + defined.size();
    out += style.substr(copied, begin - copied) + style.substr(begin, at - begin) +
           style.substr(value, style.find(';', value) - value) + style.substr(closed + 1, end - closed) + " ";
    copied = begin;
    out += style.substr(copied, end - copied);
    copied = end;
  }
  return out + style.substr(copied);
}

}  // namespace

void write_svg(const std::filesystem::path& file, const Figure& figure) {
  std::string svg = render_svg(figure).svg;
  svg.insert(svg.find('>') + 1,
             "\n<style><![CDATA[" +
                 with_plain_colours(page_style() + std::string("svg { background: var(--ground); }")) + "]]></style>");
  write_durably(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg);
}

}  // namespace grainlaw::app::report
