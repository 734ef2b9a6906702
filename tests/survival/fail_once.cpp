// Preloaded (LD_PRELOAD) by every_fault.sh: the N-th call of one kind since main() began fails, as memory, disk and system do.
//   FAULT_KIND   alloc, write, fsync, rename, open, read, folder or thread
//   FAULT_AT     N; 0: none fails, they are only counted
//   FAULT_MODE   once (default), or on: N and all later ones; a write to standard error is spared then, as full disks do
//   FAULT_ERRNO  what errno says, a number
//   FAULT_LOG    file for "struck KIND N 0 CALL" when it happens and "count KIND CALLS" at the end
//   FAULT_PLACES 1: also "place KIND N WHERE CALL" for the first call of each place, told apart by WHERE: a few of its callers
//   FAULT_TRACE  1: also the stack of the struck call
//   FAULT_SERVE  1: main() is run by a child for each line "FOLDER KIND N MODE ERRNO" of standard input, in FOLDER, with standard output
//                in FOLDER.said and standard error in FOLDER.log; its exit code goes to standard output. So libraries are loaded once.
// Not seen are calls that glibc makes within itself: the open in fopen (fopen itself is), the write in fflush, the mmap of large
// blocks; and what the loader and the constructors of libraries do before main().

#include <dirent.h>
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

enum Kind { alloc, write_, fsync_, rename_, open_, read_, folder, thread, kinds };
constexpr std::array<const char*, kinds> kNames{"alloc", "write", "fsync",  "rename",
                                                "open",  "read",  "folder", "thread"};

std::atomic<bool> armed{false};  // while main() runs
std::array<std::atomic<unsigned long>, kinds> counts;
Kind chosen = kinds;
unsigned long at = 0;
bool from_then_on = false, trace = false, places = false;
int reason = 0, log_file = -1;

/// One line of FAULT_LOG.
void say(const char* what, Kind kind, unsigned long n, const char* call, std::size_t place = 0) {
  std::array<char, 120> line{};
  const int length = std::snprintf(line.data(), line.size(), "%s %s %lu %zx %s\n", what, kNames[kind], n, place, call);
  if (log_file >= 0) static_cast<void>(!write(log_file, line.data(), static_cast<std::size_t>(length)));
}

constexpr int kDepth = 6;  // callers that tell places apart, two of which are ours
constexpr std::size_t kPlaces = 1 << 20;
std::array<std::atomic<std::size_t>, kPlaces> seen_places;            // a table of hashes, 0 where there is none
[[gnu::tls_model("initial-exec")]] thread_local bool within = false;  // a call of ours, which is not counted

/// A number for the place of this call; 0 when it was seen before.
std::size_t new_place(Kind kind) {
  std::array<void*, kDepth> callers{};
  backtrace(callers.data(), kDepth);
  std::size_t hash = kind + 1;
  for (void* const caller : callers)
    hash = (hash ^ reinterpret_cast<std::size_t>(caller)) * 0x9e3779b97f4a7c15 + (hash >> 29);
  for (std::size_t i = hash % kPlaces;; i = (i + 1) % kPlaces) {
    std::size_t found = 0;
    if (seen_places[i].compare_exchange_strong(found, hash | 1)) return hash | 1;
    if (found == (hash | 1)) return 0;
  }
}

/// Whether this call is one that fails.
bool fails(Kind kind, const char* call) {
  if (within || !armed.load(std::memory_order_relaxed)) return false;
  const unsigned long n = ++counts[kind];
  if (places) {
    within = true;
    if (const std::size_t place = new_place(kind); place != 0) say("place", kind, n, call, place);
    within = false;
  }
  if (kind != chosen || at == 0 || (from_then_on ? n < at : n != at)) return false;
  if (n == at) {
    within = true;
    say("struck", kind, n, call);
    if (trace) {
      std::array<void*, 40> frames{};
      backtrace_symbols_fd(frames.data(), backtrace(frames.data(), 40), log_file);
    }
    within = false;
  }
  errno = reason;
  return true;
}

bool spared(int descriptor) { return descriptor == STDERR_FILENO && from_then_on; }

template <class Function>
Function next_of(Function, const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

int (*real_main)(int, char**, char**);

/// The value of a variable of the environment; empty when it is not set.
const char* text(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}
unsigned long number(const char* name) { return std::strtoul(text(name), nullptr, 10); }

/// Runs main() and counts its calls.
int counted_main(int argc, char** argv, char** environment) {
  for (int k = 0; k < kinds; ++k)
    if (std::strcmp(text("FAULT_KIND"), kNames[static_cast<std::size_t>(k)]) == 0) chosen = static_cast<Kind>(k);
  from_then_on = std::strcmp(text("FAULT_MODE"), "on") == 0;
  at = number("FAULT_AT");
  reason = static_cast<int>(number("FAULT_ERRNO"));
  trace = number("FAULT_TRACE") == 1;
  places = number("FAULT_PLACES") == 1;
  std::array<void*, 2> frames{};
  if (trace || places) backtrace(frames.data(), 2);  // loads what it needs
  if (std::getenv("FAULT_LOG")) log_file = open(text("FAULT_LOG"), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  armed = true;
  const int code = real_main(argc, argv, environment);
  armed = false;
  for (int k = 0; k < kinds; ++k)
    say("count", static_cast<Kind>(k), counts[static_cast<std::size_t>(k)].load(), "calls");
  return code;
}

void redirect(int stream, const std::string& file, int flags) {
  const int opened = open(file.c_str(), flags, 0666);
  dup2(opened, stream);
  close(opened);
}

/// One line of those that FAULT_SERVE stands for, in the child.
int serve_one(const char* line, int argc, char** argv, char** environment) {
  std::array<char, 500> folder{};
  std::array<char, 20> kind{}, n{}, mode{}, error{};
  if (std::sscanf(line, "%499s %19s %19s %19s %19s", folder.data(), kind.data(), n.data(), mode.data(), error.data()) !=
      5)
    return 99;
  setenv("FAULT_KIND", kind.data(), 1);
  setenv("FAULT_AT", n.data(), 1);
  setenv("FAULT_MODE", mode.data(), 1);
  setenv("FAULT_ERRNO", error.data(), 1);
  redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
  redirect(STDOUT_FILENO, std::string(folder.data()) + ".said", O_WRONLY | O_CREAT | O_TRUNC);
  redirect(STDERR_FILENO, std::string(folder.data()) + ".log", O_WRONLY | O_CREAT | O_TRUNC);
  if (chdir(folder.data()) != 0) return 99;
  return counted_main(argc, argv, environment);
}

int served_main(int argc, char** argv, char** environment) {
  if (number("FAULT_SERVE") != 1) return counted_main(argc, argv, environment);
  std::array<char, 1000> line{};
  while (std::fgets(line.data(), line.size(), stdin)) {
    const pid_t child = fork();
    if (child == 0) return serve_one(line.data(), argc, argv, environment);
    int status = 0;
    waitpid(child, &status, 0);
    std::printf("%d\n", WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

// The call RESULT NAME(PARAMETERS) of KIND, which returns FAILURE when it fails and calls the next NAME(ARGUMENTS) else.
#define FAILING(KIND, RESULT, FAILURE, NAME, PARAMETERS, ARGUMENTS) \
  extern "C" RESULT NAME PARAMETERS {                               \
    static const auto next = next_of(&NAME, #NAME);                 \
    if (fails(KIND, #NAME)) return FAILURE;                         \
    return next ARGUMENTS;                                          \
  }
// Likewise of a descriptor.
#define FAILING_WRITE(RESULT, NAME, PARAMETERS, ARGUMENTS) \
  extern "C" RESULT NAME PARAMETERS {                      \
    static const auto next = next_of(&NAME, #NAME);        \
    if (!spared(file) && fails(write_, #NAME)) return -1;  \
    return next ARGUMENTS;                                 \
  }
// An open with a mode that is there only with O_CREAT or O_TMPFILE.
#define FAILING_OPEN(NAME, PARAMETERS, ARGUMENTS, ...) \
  extern "C" int NAME PARAMETERS {                     \
    static const auto next = next_of(&NAME, #NAME);    \
    mode_t mode = 0;                                   \
    if ((flags & (O_CREAT | __O_TMPFILE)) != 0) {      \
      va_list list;                                    \
      va_start(list, flags);                           \
      mode = va_arg(list, mode_t);                     \
      va_end(list);                                    \
    }                                                  \
    if (fails(open_, #NAME)) return -1;                \
    return next ARGUMENTS;                             \
  }

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  static const auto next = next_of(&__libc_start_main, "__libc_start_main");
  return next(served_main, argc, argv, init, fini, rtld_fini, stack_end);
}

void* malloc(std::size_t n) { return fails(alloc, "malloc") ? nullptr : __libc_malloc(n); }
void* calloc(std::size_t n, std::size_t size) { return fails(alloc, "calloc") ? nullptr : __libc_calloc(n, size); }
void* realloc(void* p, std::size_t n) { return fails(alloc, "realloc") ? nullptr : __libc_realloc(p, n); }
void* memalign(std::size_t step, std::size_t n) {
  return fails(alloc, "memalign") ? nullptr : __libc_memalign(step, n);
}
void* aligned_alloc(std::size_t step, std::size_t n) {
  return fails(alloc, "aligned_alloc") ? nullptr : __libc_memalign(step, n);
}
int posix_memalign(void** p, std::size_t step, std::size_t n) {
  void* const block = fails(alloc, "posix_memalign") ? nullptr : __libc_memalign(step, n);
  if (!block) return ENOMEM;
  *p = block;
  return 0;
}

// Its caller learns of an error from the stream.
std::size_t fread(void* to, std::size_t size, std::size_t n, FILE* stream) {
  static const auto next = next_of(&fread, "fread");
  if (!fails(read_, "fread")) return next(to, size, n, stream);
  stream->_flags |= 0x20;  // _IO_ERR_SEEN
  return 0;
}
// Writes a part and fails at the rest, as a disk does that runs full.
ssize_t write(int file, const void* bytes, std::size_t n) {
  static const auto next = next_of(&write, "write");
  if (spared(file) || file == log_file || !fails(write_, "write")) return next(file, bytes, n);
  if (n > 1) static_cast<void>(!next(file, bytes, n / 2));
  errno = reason;
  return -1;
}
int close(int file) {
  static const auto next = next_of(&close, "close");
  const int result = next(file);
  return fails(fsync_, "close") ? -1 : result;
}
int pthread_create(pthread_t* made, const pthread_attr_t* attributes, void* (*body)(void*), void* argument) {
  static const auto next = next_of(&pthread_create, "pthread_create");
  return fails(thread, "pthread_create") ? reason : next(made, attributes, body, argument);
}
}

FAILING_WRITE(ssize_t, writev, (int file, const iovec* parts, int n), (file, parts, n))
FAILING_WRITE(ssize_t, pwrite, (int file, const void* bytes, std::size_t n, off_t place), (file, bytes, n, place))
FAILING_WRITE(ssize_t, pwrite64, (int file, const void* bytes, std::size_t n, off64_t place), (file, bytes, n, place))
FAILING(fsync_, int, -1, fsync, (int file), (file))
FAILING(fsync_, int, -1, fdatasync, (int file), (file))
FAILING(rename_, int, -1, rename, (const char* from, const char* to), (from, to))
FAILING(rename_, int, -1, renameat, (int a, const char* from, int b, const char* to), (a, from, b, to))
FAILING(rename_, int, -1, renameat2, (int a, const char* from, int b, const char* to, unsigned flags),
        (a, from, b, to, flags))
FAILING_OPEN(open, (const char* file, int flags, ...), (file, flags, mode))
FAILING_OPEN(open64, (const char* file, int flags, ...), (file, flags, mode))
FAILING_OPEN(openat, (int place, const char* file, int flags, ...), (place, file, flags, mode))
FAILING_OPEN(openat64, (int place, const char* file, int flags, ...), (place, file, flags, mode))
FAILING(open_, FILE*, nullptr, fopen, (const char* file, const char* mode), (file, mode))
FAILING(open_, FILE*, nullptr, fopen64, (const char* file, const char* mode), (file, mode))
FAILING(open_, DIR*, nullptr, opendir, (const char* name), (name))
FAILING(open_, DIR*, nullptr, fdopendir, (int file), (file))
FAILING(open_, int, -1, dup, (int file), (file))
FAILING(open_, int, -1, pipe2, (int* ends, int flags), (ends, flags))
FAILING(read_, ssize_t, -1, read, (int file, void* to, std::size_t n), (file, to, n))
FAILING(read_, ssize_t, -1, pread, (int file, void* to, std::size_t n, off_t place), (file, to, n, place))
FAILING(read_, ssize_t, -1, pread64, (int file, void* to, std::size_t n, off64_t place), (file, to, n, place))
FAILING(folder, int, -1, mkdir, (const char* name, mode_t mode), (name, mode))
FAILING(folder, int, -1, mkdirat, (int place, const char* name, mode_t mode), (place, name, mode))
FAILING(folder, int, -1, unlink, (const char* name), (name))
FAILING(folder, int, -1, unlinkat, (int place, const char* name, int flags), (place, name, flags))
FAILING(folder, int, -1, rmdir, (const char* name), (name))
FAILING(folder, int, -1, remove, (const char* name), (name))
FAILING(folder, dirent*, nullptr, readdir, (DIR * place), (place))
FAILING(folder, dirent64*, nullptr, readdir64, (DIR * place), (place))
