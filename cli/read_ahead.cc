// SPDX-License-Identifier: Apache-2.0
#include "cli/read_ahead.h"

#include <utility>

namespace rsstab::cli {
namespace {

constexpr std::size_t kFramesAhead = 3;  // at 4K each one takes 12 to 25 MB

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
    Item item = reader_->Read();
    const bool last = !item || !*item;
    if (!queue_.Push(std::move(item)) || last) {
      break;
    }
  }
  queue_.Close();
}

}  // namespace rsstab::cli
