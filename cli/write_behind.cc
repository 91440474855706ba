// SPDX-License-Identifier: Apache-2.0
#include "cli/write_behind.h"

#include <exception>
#include <new>
#include <utility>

namespace rsstab::cli {
namespace {

constexpr std::size_t kFramesWaiting = 3;  // at 4K each one takes 12 to 25 MB

// An exception must not leave the thread.
Status WriteSafely(media::VideoWriter& writer, const Frame& frame) {
  try {
    return writer.Write(frame);
  } catch (const std::bad_alloc&) {
    return Fail(ErrorCode::kIo, "out of memory while encoding");
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kInternal, "encoding failed: {}", exception.what());
  }
}

}  // namespace

WriteBehind::WriteBehind(std::unique_ptr<media::VideoWriter> writer)
    : writer_(std::move(writer)), queue_(kFramesWaiting), thread_([this] { Run(); }) {}

WriteBehind::~WriteBehind() {
  {
    const std::lock_guard lock(mutex_);
    abandoned_ = true;
  }
  Stop();
}

Status WriteBehind::Write(Frame frame) {
  if (!queue_.Push(std::move(frame))) {
    return FirstError();  // the thread closes the queue only after an error
  }
  return {};
}

Status WriteBehind::Finish() {
  Stop();
  if (Status status = FirstError(); !status) {
    return status;
  }
  return writer_->Finish();
}

void WriteBehind::Stop() {
  queue_.Close();
  if (thread_.joinable()) {
    thread_.join();
  }
}

Status WriteBehind::FirstError() {
  const std::lock_guard lock(mutex_);
  return status_;
}

void WriteBehind::Run() {
  while (std::optional<Frame> frame = queue_.Pop()) {
    {
      const std::lock_guard lock(mutex_);
      if (abandoned_) {
        return;
      }
    }
    if (Status status = WriteSafely(*writer_, *frame); !status) {
      {
        const std::lock_guard lock(mutex_);
        status_ = std::move(status);
      }
      queue_.Close();
      return;
    }
  }
}

}  // namespace rsstab::cli
