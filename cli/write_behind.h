// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_WRITE_BEHIND_H_
#define RSSTAB_CLI_WRITE_BEHIND_H_

#include <memory>
#include <mutex>
#include <thread>

#include "cli/bounded_queue.h"
#include "cli/media/video_writer.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Encodes frames in a thread of its own while the next ones are rendered. Used by one thread.
// Destroyed without Finish() it drops what is left, and the writer removes its unfinished file.
class WriteBehind {
 public:
  explicit WriteBehind(std::unique_ptr<media::VideoWriter> writer);
  ~WriteBehind();
  WriteBehind(const WriteBehind&) = delete;
  WriteBehind& operator=(const WriteBehind&) = delete;

  // As VideoWriter::Write(), but an error may show up a few frames late or in Finish().
  [[nodiscard]] Status Write(Frame frame);

  // Waits for all frames and completes the file.
  [[nodiscard]] Status Finish();

 private:
  void Run();
  [[nodiscard]] Status FirstError();
  void Stop();

  std::unique_ptr<media::VideoWriter> writer_;
  BoundedQueue<Frame> queue_;
  std::mutex mutex_;
  Status status_;           // guarded by mutex_
  bool abandoned_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_WRITE_BEHIND_H_
