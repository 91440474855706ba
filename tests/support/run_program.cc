// SPDX-License-Identifier: Apache-2.0
#include "tests/support/run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <stdexcept>

namespace rsstab::testing {
namespace {

using Clock = std::chrono::steady_clock;

struct Pipe {
  int read_end = -1;
  int write_end = -1;

  Pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw std::runtime_error("cannot make a pipe");
    }
    read_end = ends[0];
    write_end = ends[1];
  }
  ~Pipe() {
    CloseRead();
    CloseWrite();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  void CloseRead() { Close(read_end); }
  void CloseWrite() { Close(write_end); }
  static void Close(int& end) {
    if (end >= 0) {
      close(end);
      end = -1;
    }
  }
};

// In the child, between fork and exec: only calls that are safe there.
[[noreturn]] void BecomeProgram(const char* program, char* const* arguments, const char* folder,
                                const ProgramSettings& settings, int out, int err) {
  const int null = open("/dev/null", O_RDONLY);
  if (null < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
      dup2(err, STDERR_FILENO) < 0 || chdir(folder) != 0) {
    _exit(125);
  }
  if (settings.max_file_bytes) {
    const rlimit limit = {*settings.max_file_bytes, *settings.max_file_bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  execv(program, arguments);
  _exit(126);
}

// Appends what there is to read; false at the end.
bool Drain(int descriptor, std::string& text) {
  std::array<char, 65536> buffer{};
  const ssize_t count = read(descriptor, buffer.data(), buffer.size());
  if (count > 0) {
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return count > 0;
}

}  // namespace

ProgramResult RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                         const ProgramSettings& settings) {
  Pipe out;
  Pipe err;
  std::vector<std::string> words = {program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);
  const std::string folder = settings.folder.string();

  const pid_t child = fork();
  if (child < 0) {
    throw std::runtime_error("cannot start " + program);
  }
  if (child == 0) {
    BecomeProgram(program.c_str(), argv.data(), folder.c_str(), settings, out.write_end,
                  err.write_end);
  }
  out.CloseWrite();
  err.CloseWrite();
  if (settings.close_output) {
    out.CloseRead();
  }

  ProgramResult result;
  const auto deadline = Clock::now() + std::chrono::duration<double>(settings.timeout_s);
  bool signalled = settings.signal_after.empty();
  while (out.read_end >= 0 || err.read_end >= 0) {
    std::array<pollfd, 2> wait = {pollfd{out.read_end, POLLIN, 0}, pollfd{err.read_end, POLLIN, 0}};
    poll(wait.data(), wait.size(), 50);
    if (wait[0].revents != 0 && !Drain(out.read_end, result.output)) {
      out.CloseRead();
    }
    if (wait[1].revents != 0 && !Drain(err.read_end, result.error)) {
      err.CloseRead();
    }
    if (!signalled && result.error.find(settings.signal_after) != std::string::npos) {
      kill(child, settings.signal);
      signalled = true;
    }
    if (!result.timed_out && Clock::now() > deadline) {
      result.timed_out = true;
      kill(child, SIGKILL);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status)) {
    result.exit_code = WEXITSTATUS(status);
  } else if (WIFSIGNALED(status)) {
    result.signal = WTERMSIG(status);
  }
  return result;
}

}  // namespace rsstab::testing
