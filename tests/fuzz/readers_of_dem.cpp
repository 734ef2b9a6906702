#include "dem/files/checkpoint.hpp"
#include "dem/files/sphere_table.hpp"
#include "dem/files/state_file.hpp"
#include "dem/runs/pictures.hpp"
#include "dem/runs/preparation_folder.hpp"
#include "dem/runs/run_store.hpp"
#include "dem/runs/runs.hpp"
#include "dem/runs/spec_file.hpp"
#include "dem/runs/task_list.hpp"
#include "dem/runs/test_file.hpp"
#include "model/files/json_document.hpp"
#include "model/files/output.hpp"
#include "tests/fuzz/readers.hpp"

namespace grainlaw::fuzz {
namespace {

namespace fs = std::filesystem;

/// What was read as a file again, and that read.
template <class Read, class Write>
void check_file_round_trip(const fs::path& file, const Read& read, const Write& write) {
  const fs::path again = file.parent_path() / "again";
  const auto first = read(file);
  const auto text_of = [&](const auto& what) {
    write(again, what);
    return content(again);
  };
  check_round_trip([&] { return text_of(first); }, [&](const std::string&) { return text_of(read(again)); });
}

/// Where none is at hand: one of a run that has just begun.
void make_checkpoint(const fs::path& scene) {
  dem::Checkpoint checkpoint;
  checkpoint.segment_steps = checkpoint.steps = 1;
  checkpoint.state = dem::read_state(scene / "state/end.state");
  checkpoint.segment_H = checkpoint.state.packing.H;
  checkpoint.rows = {Observation{}, Observation{}};
  for (Observation& row : checkpoint.rows)
    row.fabric.tensor.setIdentity(), row.stress.tensor.setIdentity(), row.strain.tensor.setZero();
  dem::write_checkpoint(scene / "checkpoint/checkpoint", checkpoint);
}

}  // namespace

std::vector<Reader> readers_of_dem(const fs::path& scene) {
  make_checkpoint(scene);
  const Eigen::Matrix3d cell = dem::read_state(scene / "state/end.state").packing.H;
  return {
      {"spec", Shape::json, "",
       [](std::string_view bytes, const fs::path&) {
         const dem::Spec spec = dem::spec_from_json(parse_json(bytes, "bytes", JsonSource::user), "bytes");
         check_round_trip([&] { return json_text(dem::spec_to_json(spec)); },
                          [](const std::string& text) {
                            return json_text(dem::spec_to_json(
                                dem::spec_from_json(parse_json(text, "again", JsonSource::user), "again")));
                          });
       }},
      {"test", Shape::json, "test/test.json", [](std::string_view, const fs::path& file) { dem::read_test(file); }},
      {"spheres", Shape::csv, "spheres/spheres.csv",
       [cell](std::string_view, const fs::path& file) {
         const dem::State state = dem::read_spheres(file, cell, {});
         check_round_trip(
             [&] {
               dem::write_spheres(file.parent_path() / "again.csv", state.packing);
               return std::to_string(state.packing.size());
             },
             [&](const std::string&) {
               return std::to_string(dem::read_spheres(file.parent_path() / "again.csv", cell, {}).packing.size());
             });
       }},
      {"state", Shape::sealed, "state/state",
       [](std::string_view, const fs::path& file) {
         check_file_round_trip(file, dem::read_state,
                               [](const fs::path& to, const dem::State& state) { dem::write_state(to, state); });
       }},
      {"checkpoint", Shape::sealed, "checkpoint/checkpoint",
       [](std::string_view, const fs::path& file) {
         check_file_round_trip(file, dem::read_checkpoint, dem::write_checkpoint);
       }},
      {"run", Shape::json, "store/runs/key/run.json",
       [store = std::make_shared<dem::RunStore>(scene / "store", "runs")](std::string_view, const fs::path&) {
         const auto record = store->find("key");
         if (!record || record->at("packing").is_null()) return;
         dem::packing_from_record(*record);
         dem::cost_from_record(*record);
       }},
      {"progress", Shape::json, "progress/progress.json",
       [](std::string_view, const fs::path& file) {
         dem::PreparationFolder folder(file.parent_path(), "key", ContactModel{});
         if (!folder.take_up()) return;
         json_text(folder.packing({}));
         json_text(folder.states());
         json_text(folder.warnings());
       }},
      {"tasks", Shape::json, "listed/tasks/tasks.json",
       [](std::string_view, const fs::path& file) { dem::read_tasks(file.parent_path().parent_path()); }},
      {"pictures", Shape::json, "pictures/pictures.json",
       [](std::string_view, const fs::path& file) { dem::read_pictures(file.parent_path()); }},
  };
}

}  // namespace grainlaw::fuzz
