#pragma once
// LAMMPS as a program of its own: found, asked what it is, started without a shell, ended.

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::dem {

inline constexpr std::string_view kKnownLammps = "29 Sep 2021";  ///< version that the decks were tried with

struct LammpsProgram {
  std::filesystem::path executable;   ///< absolute
  std::string version;                ///< as it says itself: "29 Sep 2021 - Update 2"
  std::vector<std::string> launcher;  ///< words before it; empty: one process

  bool is_known() const { return version.starts_with(kKnownLammps); }
};

/// `executable`: a file or a name on PATH, empty: $GRAINLAW_LAMMPS, else lmp; `launcher`: words parted by blanks, empty:
/// $GRAINLAW_LAUNCHER. Throws InvalidInput naming both and the remedy when one is not there, is no LAMMPS, or lacks the
/// package GRANULAR.
LammpsProgram find_lammps(const std::string& executable, const std::string& launcher);

/// A child process with a group of its own, so that Ctrl-C reaches it through us alone. It ends with this object, and by
/// SIGTERM when we are killed.
class Process {
 public:
  /// Starts words[0] (sought on PATH) in `folder`; its output goes to the file descriptor `output`, it reads nothing. Of MPI
  /// it may use its own memory alone where `alone`. Throws Error with the system's reason.
  Process(const std::vector<std::string>& words, const std::filesystem::path& folder, int output, bool alone);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool running();  ///< asks, does not wait
  bool succeeded() const { return status_ == 0; }
  std::string how_it_ended() const;  ///< "with exit code 1", "by signal 9 (Killed)"

 private:
  pid_t pid_ = -1;
  int status_ = -1;
  bool ended_ = false;
};

}  // namespace grainlaw::dem
