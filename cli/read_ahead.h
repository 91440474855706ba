// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_READ_AHEAD_H_
#define RSSTAB_CLI_READ_AHEAD_H_

#include <memory>
#include <optional>
#include <thread>

#include "cli/bounded_queue.h"
#include "cli/media/video_reader.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Decodes a few frames ahead in a thread of its own, so that decoding and what is done with the
// frames share the processors. Used by one thread.
class ReadAhead {
 public:
  explicit ReadAhead(std::unique_ptr<media::VideoReader> reader);
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  [[nodiscard]] const media::VideoInfo& info() const { return reader_->info(); }

  // As VideoReader::Read(). Once it has returned the end or an error it is not called again.
  [[nodiscard]] Result<std::optional<media::VideoFrame>> Next();

 private:
  using Item = Result<std::optional<media::VideoFrame>>;
  void Run();

  std::unique_ptr<media::VideoReader> reader_;
  BoundedQueue<Item> queue_;
  std::thread thread_;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_READ_AHEAD_H_
