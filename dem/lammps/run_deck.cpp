// One call of LAMMPS: its deck written, its looks followed, its death told.

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

#include "dem/lammps/lammps_test.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kBetweenLooks{10};
constexpr const char* kMarks = "marks";
constexpr std::streamoff kTail = 4000;  // of a log that is looked through [byte]

/// The last lines of a file that say something.
std::vector<std::string> last_lines(const fs::path& file, std::size_t count) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - kTail));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) lines.push_back(one_line(line, 200));
  }
  if (lines.size() > count) lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(count));
  return lines;
}

/// Complete lines that have been added to a file since it was asked.
class GrowingFile {
 public:
  explicit GrowingFile(fs::path file) : file_(std::move(file)) {}

  std::vector<std::string> more() {
    std::vector<std::string> lines;
    std::ifstream in(file_, std::ios::binary);
    in.seekg(read_);
    for (std::string line; std::getline(in, line) && !in.eof();) {
      read_ += static_cast<std::streamoff>(line.size()) + 1;
      lines.push_back(line);
    }
    return lines;
  }

 private:
  fs::path file_;
  std::streamoff read_ = 0;
};

}  // namespace

void run_deck(const LammpsPlace& place, const std::string& name, const std::string& deck, const RunControl& control,
              const std::function<void(const std::string& look)>& on_look) {
  const std::string input = name + ".in", log = name + ".log", output = name + ".out";
  fs::remove(place.folder / kMarks);
  write_durably(place.folder / input, deck);
  std::vector<std::string> words = place.program.launcher;
  for (const std::string& word : {place.program.executable.string(), std::string("-in"), input, std::string("-log"),
                                  log, std::string("-screen"), std::string("none"), std::string("-nocite")})
    words.push_back(word);
  const fs::path output_file = place.folder / output;
  const int out = open(output_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (out < 0) throw Error(fmt::format("{}: cannot be created: {}", output_file.string(), std::strerror(errno)));
  std::optional<Process> process;
  try {
    process.emplace(words, place.folder, out, place.program.launcher.empty());
  } catch (...) {
    close(out);
    throw;
  }
  close(out);
  GrowingFile marks(place.folder / kMarks);
  for (bool running = true; running;) {
    running = process->running();  // before the marks, so that the last ones are seen
    for (const std::string& look : marks.more()) on_look(look);
    if (control.stop.stop_requested()) throw Interrupted("LAMMPS: interrupted on request");
    if (running) std::this_thread::sleep_for(kBetweenLooks);
  }
  if (process->succeeded()) return;
  std::vector<std::string> said = last_lines(place.folder / log, 3);
  for (const std::string& line : last_lines(output_file, 2)) said.push_back(line);
  throw Error(
      fmt::format("LAMMPS ended {}: {} ({}); the same command goes on from its last restart file, or from the "
                  "beginning of the stage",
                  process->how_it_ended(), fmt::join(said, " | "), (place.folder / log).string()));
}

}  // namespace grainlaw::dem
