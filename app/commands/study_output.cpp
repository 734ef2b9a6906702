#include "app/commands/study_output.hpp"

#include "app/report/svg_figure.hpp"
#include "model/files/provenance.hpp"

namespace grainlaw::app {

void finish_study(const std::filesystem::path& folder, OrderedJson document, const std::string& figure_file,
                  const report::Figure& figure, const std::string& text, const Session& session) {
  document["provenance"] = provenance(session);
  write_json(folder / "study.json", document);
  report::write_svg(folder / figure_file, figure);
  print_result(session.json ? json_text(document) : text + (folder / "study.json").string() + "\n");
}

}  // namespace grainlaw::app
