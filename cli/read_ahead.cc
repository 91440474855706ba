// SPDX-License-Identifier: Apache-2.0
#include "cli/read_ahead.h"

#include <exception>
#include <new>
#include <utility>

namespace rsstab::cli {
namespace {

constexpr std::size_t kFramesAhead = 3;  // at 4K each one takes 12 to 25 MB

// An exception must not end the thread: without an item it would look like the end of the clip.
Result<std::optional<media::VideoFrame>> ReadSafely(media::VideoReader& reader) {
  try {
    return reader.Read();
  } catch (const std::bad_alloc&) {
    return Fail(ErrorCode::kIo, "out of memory while decoding");
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kInternal, "decoding failed: {}", exception.what());
  }
}

}  // namespace

ReadAhead::ReadAhead(std::unique_ptr<media::VideoReader> reader)
    : reader_(std::move(reader)), queue_(kFramesAhead), thread_([this] { Run(); }) {}

ReadAhead::~ReadAhead() {
  queue_.Close();
  thread_.join();
}

Result<std::optional<media::VideoFrame>> ReadAhead::Next() {
  std::optional<Item> item = queue_.Pop();
  return item ? std::move(*item) : Item(std::nullopt);
}

void ReadAhead::Run() {
  while (true) {
    Item item = ReadSafely(*reader_);
    const bool last = !item || !*item;
    if (!queue_.Push(std::move(item)) || last) {
      break;
    }
  }
  queue_.Close();
}

}  // namespace rsstab::cli
