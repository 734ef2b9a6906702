#pragma once
// The readers of foreign bytes, each as one call that a fuzzer makes with bytes of its own. What must hold of every call: it
// ends soon and in little memory, it refuses by grainlaw::Error alone, in one line that names the file, and what it accepts
// has no infinite number and can be written and read again.

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::fuzz {

enum class Shape {
  json,
  csv,     ///< lines of fields between commas or, without any, blanks
  binary,  ///< bytes
  sealed,  ///< of dem/files/sealed_file.hpp without the checksum, which is put behind the mutated bytes
};

struct Reader {
  std::string name;
  Shape shape = Shape::json;
  std::string file;  ///< that the bytes are put into, relative to the scene; empty: they are read where they are
  std::function<void(std::string_view bytes, const std::filesystem::path& file)> read;
};

/// What a reader must not do.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

/// All of them; `scene` is the folder that tests/fuzz/scene.sh has made, in which files are replaced.
std::vector<Reader> readers(const std::filesystem::path& scene);

/// One call; whether the bytes were accepted. Throws Finding, or whatever the reader throws besides Error.
bool accepts(const Reader& reader, std::string_view bytes);

/// Throws Finding unless the refusal names the file, or the folder of all, in one line of text.
void check_message(const std::string& message, const std::string& name);

/// Sound files of its kind as `reader` gets them, sealed ones without the checksum: its own and those of seeds/READER.
std::vector<std::string> seeds(const Reader& reader, const std::filesystem::path& scene);

std::string content(const std::filesystem::path& file);

// What the readers are made of, by room:
std::vector<Reader> readers_of_model(const std::filesystem::path& scene);
std::vector<Reader> readers_of_dem(const std::filesystem::path& scene);
std::vector<Reader> readers_of_imports(const std::filesystem::path& scene);
std::vector<Reader> readers_of_the_law(const std::filesystem::path& scene);  ///< model, fit, predict, chain

/// Throws Finding when what was read cannot be written, or `again` does not read it back as the same text.
void check_round_trip(const std::function<std::string()>& write,
                      const std::function<std::string(const std::string& text)>& again);

}  // namespace grainlaw::fuzz
