#include "app/terminal/progress_printer.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/files/one_line.hpp"

namespace grainlaw::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTerminalInterval = 0.2;  // [s]
constexpr double kLogInterval = 5;         // [s]

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

std::string rate_text(double rate, const std::string& unit) {
  if (rate >= 1e6) return fmt::format("{:.1f} million {}/s", rate / 1e6, unit);
  return fmt::format("{:.0f} {}/s", rate, unit);
}

}  // namespace

std::string clock_text(double seconds) {
  const auto s = static_cast<long>(std::min(std::ceil(seconds), 3.6e8));
  return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                   : fmt::format("{}:{:02}", s / 60, s % 60);
}

ProgressPrinter::ProgressPrinter(std::FILE* out, bool quiet)
    : out_(out), quiet_(quiet), terminal_(isatty(fileno(out)) == 1) {}

void ProgressPrinter::begin(const std::vector<double>& work, std::string unit) {
  JobRecord::begin(work, std::move(unit));
  began_ = printed_ = Clock::now();
}

void ProgressPrinter::changed(bool finished) {
  const double interval = terminal_ ? kTerminalInterval : kLogInterval;
  if (finished ? terminal_ : seconds_since(printed_) >= interval) print();
}

std::string ProgressPrinter::status() const {
  const double elapsed = seconds_since(began_);
  double expected = 0, covered = 0, earlier = 0, worked = 0;
  std::size_t done = 0;
  std::string running;
  if (unit_.empty()) {
    for (const Job& job : jobs_) {
      expected += job.expected;
      covered += this->covered(job);
      if (job.running) running = job.stage.empty() ? job.name : fmt::format("{}, {}", job.name, job.stage);
    }
    const std::string text = fmt::format("{:3.0f} %", expected > 0 ? 100 * covered / expected : 100);
    const std::string left = elapsed > 1 && covered > 0.02 * expected
                                 ? fmt::format(", {} left", clock_text(elapsed * (expected - covered) / covered))
                                 : "";
    return fmt::format("{}{} ({})", text, left, running);
  }
  for (const Job& job : jobs_) {
    expected += job.expected;
    covered += this->covered(job);
    earlier += std::min(job.first.value_or(0), 0.99 * job.expected);
    worked += job.work - job.first.value_or(0);
    done += job.done ? 1 : 0;
    if (job.running) running += fmt::format("{}{}", running.empty() ? "" : ", ", job.name);
  }
  const double gained = covered - earlier;
  std::string text =
      fmt::format("{:3.0f} %, {} of {} runs", expected > 0 ? 100 * covered / expected : 100, done, jobs_.size());
  if (elapsed > 1 && worked > 0) text += fmt::format(", {}", rate_text(worked / elapsed, unit_));
  if (elapsed > 2 && gained > 0.005 * expected)
    text += fmt::format(", {} left", clock_text(elapsed * (expected - covered) / gained));
  return running.empty() ? text : fmt::format("{} ({})", text, running);
}

/// Progress that cannot be written is no reason to end the work: errors are ignored.
void ProgressPrinter::write(const std::string& text) { std::fputs(text.c_str(), out_); }

void ProgressPrinter::print() {
  if (quiet_) return;
  printed_ = Clock::now();
  std::string text = fmt::format("grainlaw: {}", status());
  if (terminal_) {
    winsize size{};
    const std::size_t width = ioctl(fileno(out_), TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col - 1u : 79u;
    if (text.size() > width) text.resize(width);
    write(fmt::format("\r{}\x1b[K", text));
    line_shown_ = true;
  } else {
    write(text + "\n");
  }
  std::fflush(out_);
}

void ProgressPrinter::clear_line() {
  if (line_shown_) write("\r\x1b[K");
  line_shown_ = false;
}

void ProgressPrinter::end() {
  const std::lock_guard lock(mutex_);
  if (!quiet_) clear_line();
  jobs_.clear();
  std::fflush(out_);
}

void ProgressPrinter::log(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (quiet_) return;
  clear_line();
  write(fmt::format("grainlaw: {}\n", one_line(text)));
  std::fflush(out_);
}

}  // namespace grainlaw::app
