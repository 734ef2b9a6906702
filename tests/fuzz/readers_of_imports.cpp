#include <cmath>
#include <optional>

#include "chain/import/import.hpp"
#include "model/files/series_csv.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/fuzz/readers.hpp"

namespace grainlaw::fuzz {
namespace {

namespace fs = std::filesystem;

/// All that `grainlaw import` does before it writes: what is taken must be rows as our own files may hold them.
void import_by(const chain::Mapping& mapping) {
  for (const chain::ForeignTest& test : chain::read_foreign(mapping, {})) {
    const chain::ImportedTest taken = chain::imported(mapping, test);
    if (taken.record.rows.size() < 2) throw Finding("a test of less than two rows was taken");
    series_text(taken.record.rows);
    for (const Observation& row : taken.record.rows) {
      if (!row.stress.tensor.allFinite() || !row.strain.tensor.allFinite() || !std::isfinite(row.nu))
        throw Finding("a row was taken that says no stress, strain or volume fraction");
    }
  }
}

}  // namespace

std::vector<Reader> readers_of_imports(const fs::path&) {
  const auto own = [](std::string_view, const fs::path& file) { import_by(chain::read_mapping(file)); };
  // of one file, which is not the one that changes: it is read once
  const auto beside = [mapping = std::optional<chain::Mapping>()](std::string_view, const fs::path& file) mutable {
    if (!mapping) mapping = chain::read_mapping(file.parent_path() / "mapping.json");
    import_by(*mapping);
  };
  return {
      {"mapping", Shape::json, "mapping/mapping.json", own},
      {"table", Shape::csv, "table/table.csv", beside},
      {"npy", Shape::binary, "npy/table.npy", beside},
      {"npz", Shape::binary, "npz/table.npz", beside},
      {"dump", Shape::csv, "dump/spheres.dump", beside},
      {"dump-local", Shape::csv, "dump-local/contacts.dump", beside},
      {"xyz", Shape::csv, "xyz/frames.xyz", beside},
      {"vtp", Shape::csv, "vtp/spheres.vtp", beside},
      {"vtp-encoded", Shape::binary, "vtp-encoded/spheres.vtp", beside},
      {"spheres-text", Shape::csv, "spheres-text/spheres.txt", beside},
      {"particles", Shape::json, "particles/mapping.json", own},
  };
}

}  // namespace grainlaw::fuzz
