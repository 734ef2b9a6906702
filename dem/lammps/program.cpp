#include "dem/lammps/program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

#include "dem/engine/run_watch.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;
constexpr std::chrono::seconds kAnswer{30};  // for LAMMPS to say what it is
constexpr std::chrono::seconds kGrace{5};    // between SIGTERM and SIGKILL
constexpr std::chrono::milliseconds kNap{10};
constexpr const char* kRemedy = "give --lammps FILE, or install LAMMPS (Debian package lammps)";

bool is_executable(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

std::string first_of(std::initializer_list<std::string> texts) {
  const auto given = std::find_if(texts.begin(), texts.end(), [](const std::string& text) { return !text.empty(); });
  return given == texts.end() ? "" : *given;
}

/// Absolute; empty when there is none.
fs::path on_path(const std::string& name) {
  if (name.find('/') != std::string::npos) return is_executable(name) ? fs::absolute(name) : fs::path();
  std::istringstream folders(variable("PATH"));
  folders.exceptions(std::ios::badbit);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (const fs::path file = fs::path(folder) / name; is_executable(file)) return fs::absolute(file);
  }
  return {};
}

/// What the program prints, up to 1 MB, and whether it ended well in time.
std::pair<std::string, bool> answer_of(const std::vector<std::string>& words) {
  const int memory = memfd_create("answer", MFD_CLOEXEC);
  if (memory < 0) throw Error(fmt::format("{}: no memory for its answer: {}", words[0], std::strerror(errno)));
  bool well = false;
  {
    Process process(words, "/", memory, true);
    const auto end = Clock::now() + kAnswer;
    while (process.running() && Clock::now() < end) std::this_thread::sleep_for(kNap);
    well = !process.running() && process.succeeded();
  }
  std::string text(1 << 20, '\0');
  const ssize_t size = pread(memory, text.data(), text.size(), 0);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  close(memory);
  return {text, well};
}

std::string line_after(const std::string& text, std::string_view words) {
  const std::size_t at = text.find(words);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + words.size();
  return one_line(text.substr(begin, text.find('\n', begin) - begin), 60);
}

/// The environment with what one process of LAMMPS wants unless the user says otherwise.
std::vector<std::string> environment(bool alone) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry; ++entry) all.emplace_back(*entry);
  if (!std::getenv("OMP_NUM_THREADS")) all.emplace_back("OMP_NUM_THREADS=1");
  if (alone && !std::getenv("OMPI_MCA_btl")) all.emplace_back("OMPI_MCA_btl=self");
  return all;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  for (std::string& word : words) all.push_back(word.data());
  all.push_back(nullptr);
  return all;
}

/// In the child, between fork and exec: nothing here may allocate. Returns only when something fails.
void become(char* const* words, char* const* environment, const char* folder, int output, pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);
  signal(SIGXFSZ, SIG_DFL);
  signal(SIGPIPE, SIG_DFL);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, 0) < 0 || dup2(output, 1) < 0 || dup2(output, 2) < 0 || chdir(folder) != 0) return;
  execvpe(words[0], words, environment);
}

}  // namespace

LammpsProgram find_lammps(const std::string& executable, const std::string& launcher) {
  const std::string name = first_of({executable, variable("GRAINLAW_LAMMPS"), "lmp"});
  const std::string shown = one_line(name, 200);
  LammpsProgram program;
  program.executable = on_path(name);
  if (program.executable.empty())
    throw InvalidInput(fmt::format("engine: lammps: no executable '{}'{}; {}", shown,
                                   name.find('/') == std::string::npos ? " on PATH" : "", kRemedy));
  std::istringstream words(first_of({launcher, variable("GRAINLAW_LAUNCHER")}));
  words.exceptions(std::ios::badbit);
  for (std::string word; words >> word;) program.launcher.push_back(word);
  if (!program.launcher.empty() && on_path(program.launcher[0]).empty())
    throw InvalidInput(fmt::format("--launcher: no executable '{}'; give words as \"mpirun -n 2\", without a shell",
                                   one_line(program.launcher[0], 200)));
  const auto [answer, well] = answer_of({program.executable.string(), "-h"});
  program.version = line_after(answer, "Massively Parallel Simulator - ");
  if (!well || program.version.empty())
    throw InvalidInput(
        fmt::format("engine: lammps: '{}' does not say that it is LAMMPS when called with -h; {}", shown, kRemedy));
  if (answer.find(" GRANULAR ") == std::string::npos && answer.find("\nGRANULAR ") == std::string::npos)
    throw InvalidInput(fmt::format("engine: lammps: '{}' ({}) is built without the package GRANULAR; {}", shown,
                                   program.version, kRemedy));
  return program;
}

Process::Process(const std::vector<std::string>& words, const fs::path& folder, int output, bool alone) {
  std::vector<std::string> copies = words, variables = environment(alone);
  const std::vector<char*> arguments = pointers(copies), values = pointers(variables);
  int failure[2];
  if (pipe2(failure, O_CLOEXEC) != 0) throw Error(fmt::format("{}: {}", words[0], std::strerror(errno)));
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    become(arguments.data(), values.data(), folder.c_str(), output, parent);
    const int why = errno;
    static_cast<void>(!write(failure[1], &why, sizeof why));
    _exit(127);
  }
  int why = pid_ < 0 ? errno : 0;
  close(failure[1]);
  if (pid_ > 0) {
    while (read(failure[0], &why, sizeof why) < 0 && errno == EINTR) {
    }
  }
  close(failure[0]);
  if (why == 0) return;
  if (pid_ > 0) waitpid(pid_, nullptr, 0);
  throw Error(fmt::format("{}: cannot be started: {}", words[0], std::strerror(why)));
}

Process::~Process() {
  if (ended_) return;
  kill(-pid_, SIGTERM);
  const auto end = Clock::now() + kGrace;
  while (running() && Clock::now() < end) std::this_thread::sleep_for(kNap);
  if (ended_) return;
  kill(-pid_, SIGKILL);
  waitpid(pid_, &status_, 0);
}

bool Process::running() {
  if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) != 0;
  return !ended_;
}

std::string Process::how_it_ended() const {
  if (WIFSIGNALED(status_)) return fmt::format("by signal {} ({})", WTERMSIG(status_), strsignal(WTERMSIG(status_)));
  return fmt::format("with exit code {}", WEXITSTATUS(status_));
}

}  // namespace grainlaw::dem
