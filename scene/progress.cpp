#include "scene/progress.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <ctime>

namespace sprung {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double quiet_seconds = 3.0;      // shorter runs say nothing
constexpr double terminal_interval = 0.2;  // s between renewals of the line
constexpr double line_interval = 10.0;     // s between lines elsewhere

const Clock::time_point process_start = Clock::now();

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// 75 s as "1:15", 3700 s as "1:01:40".
std::string clock_text(double seconds) {
  const long whole = std::lround(seconds);
  char text[32];
  if (whole < 3600)
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  return text;
}

}  // namespace

Progress::Progress(std::string what, double total, double start)
    : what_(std::move(what)),
      total_(total),
      start_(start),
      done_(start),
      began_(Clock::now()),
      printed_(began_),
      terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (printed_ != began_) print(done_, "", true);
}

void Progress::advance(double done, const std::string& remark) {
  done_ = done;
  const bool first = printed_ == began_;
  const double waited = seconds_since(printed_);
  const double interval = terminal_ ? terminal_interval : line_interval;
  if (waited < (first && terminal_ ? quiet_seconds : interval)) return;
  print(done, remark, false);
  printed_ = Clock::now();
}

void Progress::print(double done, const std::string& remark, bool last) {
  const double elapsed = seconds_since(began_);
  const double part = total_ > start_ ? (done - start_) / (total_ - start_) : 1.0;
  const double percent = total_ > 0.0 ? 100.0 * done / total_ : 100.0;
  char line[160];
  std::snprintf(line, sizeof line, "%s %5.1f %%  elapsed %s", what_.c_str(), percent,
                clock_text(elapsed).c_str());
  std::string text = line;
  if (!last && part > 0.0) text += "  left " + clock_text(elapsed * (1.0 - part) / part);
  if (!remark.empty()) text += "  " + remark;
  if (terminal_)
    std::fprintf(stderr, "\r%s\033[K%s", text.c_str(), last ? "\n" : "");
  else
    std::fprintf(stderr, "%s\n", text.c_str());
  std::fflush(stderr);
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double wall_seconds() {
  return seconds_since(process_start);
}

}  // namespace sprung
