#include "scene/progress.hpp"

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

namespace sprung {
namespace {

using namespace std::chrono_literals;

std::string read_all(int descriptor) {
  std::string text;
  char buffer[4096];
  for (ssize_t count; (count = read(descriptor, buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(count));
  return text;
}

void run_for(std::chrono::milliseconds duration) {
  const auto start = std::chrono::steady_clock::now();
  Progress progress("beam", 2.0);
  while (std::chrono::steady_clock::now() - start < duration) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    progress.advance(elapsed / duration, "dt 1 ms");  // half of the total at the end
    std::this_thread::sleep_for(10ms);
  }
  progress.advance(1.0);
}

TEST(Progress, ShortRunsSayNothing) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDERR_FILENO);
    run_for(200ms);
    _exit(0);
  }
  close(ends[1]);
  EXPECT_EQ(read_all(ends[0]), "");
  close(ends[0]);
  waitpid(child, nullptr, 0);
}

TEST(Progress, RenewsOneLineOnATerminal) {
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    run_for(3600ms);
    _exit(0);
  }
  const auto text = read_all(terminal);
  waitpid(child, nullptr, 0);
  close(terminal);
  EXPECT_EQ(text.find("\rbeam "), 0u) << text;
  EXPECT_NE(text.find("elapsed 0:03  left 0:04  dt 1 ms"), std::string::npos) << text;
  EXPECT_NE(text.rfind(" 50.0 %"), std::string::npos) << text;  // where it ended
  EXPECT_EQ(text.find('\n'), text.size() - 1) << text;          // one line, ended once
}

TEST(Clocks, GoForward) {
  const double processor = processor_seconds(), wall = wall_seconds();
  EXPECT_GT(processor, 0.0);
  EXPECT_GT(wall, 0.0);
  while (processor_seconds() < processor + 0.01) {
  }
  EXPECT_GE(wall_seconds(), wall + 0.005);
}

}  // namespace
}  // namespace sprung
