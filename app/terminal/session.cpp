#include "app/terminal/session.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include "model/vocabulary/error.hpp"

namespace grainlaw::app {

void print_result(const std::string& text) {
  std::string_view left = text;
  while (!left.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw Error(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
    left.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace grainlaw::app
