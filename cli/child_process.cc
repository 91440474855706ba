// SPDX-License-Identifier: Apache-2.0
#include "cli/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "cli/cancellation.h"

extern "C" char** environ;

namespace rsstab::cli {
namespace {

constexpr std::size_t kMaxText = 16U << 20U;
constexpr int kCancelCheckMs = 50;

// What the child's file descriptors and folder are to be.
class SpawnActions {
 public:
  SpawnActions(const std::filesystem::path& folder, int output) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDERR_FILENO);
    posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
  }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

// Reads to the end; false when the user asked to stop.
bool ReadAll(int descriptor, std::string& text) {
  while (true) {
    if (CancelRequested()) {
      return false;
    }
    pollfd waiting{descriptor, POLLIN, 0};
    if (poll(&waiting, 1, kCancelCheckMs) == 0) {
      continue;
    }
    std::array<char, 65536> buffer{};
    const ssize_t count = read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      return true;
    }
    if (text.size() < kMaxText) {
      text.append(buffer.data(), static_cast<std::size_t>(count));
    }
  }
}

int WaitFor(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

std::string LastLine(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) {
    text.pop_back();
  }
  const std::size_t end = text.find_last_of("\r\n");
  return end == std::string::npos ? text : text.substr(end + 1);
}

}  // namespace

Result<std::string> RunChild(const std::vector<std::string>& command,
                             const std::filesystem::path& folder) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  const std::string& program = command.front();

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    return Fail(ErrorCode::kIo, "{}: cannot be started: {}.", program, std::strerror(errno));
  }
  pid_t child = 0;
  int failed = 0;
  {
    const SpawnActions actions(folder, ends[1]);
    failed = posix_spawnp(&child, arguments[0], actions.get(), nullptr, arguments.data(), environ);
  }
  close(ends[1]);
  if (failed != 0) {
    close(ends[0]);
    return Fail(failed == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
                "{}: cannot be started: {}.", program, std::strerror(failed));
  }
  std::string text;
  const bool went_on = ReadAll(ends[0], text);
  close(ends[0]);
  if (!went_on) {
    kill(child, SIGKILL);
  }
  const int status = WaitFor(child);
  // A terminal's interrupt reaches both programs, and the other one may be quicker to end.
  if (!went_on || (status != 0 && CancelRequested())) {
    return Fail(ErrorCode::kCancelled, "stopped as asked for");
  }
  if (WIFSIGNALED(status)) {
    return Fail(ErrorCode::kIo, "{}: ended by signal {}.", program, WTERMSIG(status));
  }
  if (WEXITSTATUS(status) != 0) {
    return Fail(ErrorCode::kIo, "{}: failed with code {}: {}", program, WEXITSTATUS(status),
                LastLine(text));
  }
  return text;
}

}  // namespace rsstab::cli
