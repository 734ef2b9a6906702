#include "app/study/study_output.hpp"

#include "app/provenance.hpp"
#include "app/report/svg_figure.hpp"

namespace grainlaw::app {

OrderedJson study_document(const std::string& kind) {
  return {{"format", "grainlaw study"}, {"format_version", 1}, {"study", kind}};
}

void finish_study(const std::filesystem::path& folder, OrderedJson document, const std::string& figure_file,
                  const report::Figure& figure, const std::string& text, const Session& session) {
  document["provenance"] = provenance(session.command, session.threads, session.stopwatch);
  write_json(folder / "study.json", document);
  report::write_svg(folder / figure_file, figure);
  print_result(session.json ? json_text(document) : text + (folder / "study.json").string() + "\n");
}

}  // namespace grainlaw::app
