// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/codec_cost.h"

#include <functional>
#include <memory>
#include <utility>

#include "cli/cancellation.h"
#include "cli/passes.h"
#include "cli/read_ahead.h"
#include "cli/stopwatch.h"
#include "cli/write_behind.h"

namespace rsstab::cli {
namespace {

Result<std::unique_ptr<media::VideoReader>> Open(const std::string& clip) {
  return OpenClip(clip, {}, SilentLogger());
}

Status ForEachFrame(std::unique_ptr<media::VideoReader> clip,
                    const std::function<Status(Frame frame)>& work) {
  ReadAhead frames(std::move(clip));
  while (true) {
    auto frame = frames.Next();
    if (CancelRequested()) {
      return Fail(ErrorCode::kCancelled, "stopped as asked for");
    }
    if (!frame) {
      return Propagate(frame.error());
    }
    if (!*frame) {
      return {};
    }
    if (Status status = work(std::move((*frame)->frame)); !status) {
      return status;
    }
  }
}

Status Decode(const std::string& path) {
  auto clip = Open(path);
  return clip ? ForEachFrame(std::move(*clip), [](const Frame&) { return Status{}; })
              : Propagate(clip.error());
}

Status Recode(const std::string& path, const EncodeOptions& encode) {
  auto clip = Open(path);
  if (!clip) {
    return Propagate(clip.error());
  }
  auto output = OpenOutput(encode, {}, **clip, SilentLogger());
  if (!output) {
    return Propagate(output.error());
  }
  WriteBehind copy(std::move(output->writer));
  Status status =
      ForEachFrame(std::move(*clip), [&copy](Frame frame) { return copy.Write(std::move(frame)); });
  return status ? copy.Finish() : status;
}

}  // namespace

Result<CodecCost> MeasureCodecCost(const std::string& clip, const EncodeOptions& encode) {
  CodecCost cost;
  const Stopwatch decoding;
  if (Status status = Decode(clip); !status) {
    return Propagate(status.error());
  }
  cost.decode_s = decoding.Seconds();
  const Stopwatch recoding;
  if (Status status = Recode(clip, encode); !status) {
    return Propagate(status.error());
  }
  cost.recode_s = recoding.Seconds();
  return cost;
}

}  // namespace rsstab::cli
