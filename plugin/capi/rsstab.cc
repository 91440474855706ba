// SPDX-License-Identifier: Apache-2.0
#include "plugin/capi/rsstab.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plugin/capi/instance.h"
#include "plugin/capi/log_bridge.h"
#include "plugin/capi/picture_format.h"
#include "plugin/capi/reply.h"
#include "stabilizer/pipeline/online_options.h"
#include "stabilizer/pipeline/version.h"

struct rsstab_options {
  rsstab::capi::LastText last_text;
  rsstab::pipeline::OnlineOptions values;
  rsstab::capi::LogTarget log;
  std::string answer;  // of rsstab_options_get()
};

struct rsstab_instance {
  rsstab::capi::LastText last_text;
  std::unique_ptr<rsstab::capi::Instance> mode;
};

namespace {

using rsstab::Result;
using rsstab::capi::Guarded;
using rsstab::capi::Instance;
using rsstab::capi::InstanceSetup;
using rsstab::capi::NextFrame;
using rsstab::capi::Reply;

// The defaults as text, in the order of the table.
const std::vector<std::string>& OptionDefaults() {
  static const std::vector<std::string> defaults = [] {
    std::vector<std::string> texts;
    for (const auto& spec : rsstab::pipeline::OnlineOptionTable()) {
      texts.push_back(spec.get({}));
    }
    return texts;
  }();
  return defaults;
}

Reply NullArgument(const char* what) {
  return {RSSTAB_ERROR_INVALID_ARGUMENT, std::string(what) + " is NULL"};
}

using MakeInstance = Result<std::unique_ptr<Instance>> (*)(const InstanceSetup& setup);

rsstab_status Create(rsstab_options* options, const rsstab_video* video, const char* path,
                     MakeInstance make, rsstab_instance** instance) noexcept {
  if (instance != nullptr) {
    *instance = nullptr;
  }
  return Guarded(options, [&]() -> Reply {
    if (video == nullptr || path == nullptr || instance == nullptr) {
      return NullArgument(video == nullptr  ? "the video"
                          : path == nullptr ? "the path"
                                            : "the place for the instance");
    }
    if (rsstab::Status ok = Validate(options->values); !ok) {
      return ok;
    }
    const auto format = rsstab::capi::ToVideoFormat(*video);
    if (!format) {
      return format.error();
    }
    auto mode = make({options->values, *format, path, MakeHostLogger(options->log)});
    if (!mode) {
      return std::move(mode.error());
    }
    auto made = std::make_unique<rsstab_instance>();
    made->mode = std::move(*mode);
    *instance = made.release();
    return RSSTAB_OK;
  });
}

void Report(const NextFrame& next, int64_t* pts, void** frame_data) {
  if (pts != nullptr) {
    *pts = next.pts;
  }
  if (frame_data != nullptr) {
    *frame_data = next.frame_data;
  }
}

}  // namespace

extern "C" {

uint32_t rsstab_version(void) { return RSSTAB_VERSION; }

const char* rsstab_program_version(void) { return rsstab::pipeline::kProgramVersion; }

const char* rsstab_status_text(rsstab_status status) {
  switch (status) {
    case RSSTAB_OK:
      return "done";
    case RSSTAB_AGAIN:
      return "not now";
    case RSSTAB_END:
      return "end of the clip";
    case RSSTAB_UNCHANGED:
      return "frame left as it is";
    case RSSTAB_ERROR_INVALID_ARGUMENT:
      return "invalid argument";
    case RSSTAB_ERROR_NOT_FOUND:
      return "not found";
    case RSSTAB_ERROR_UNSUPPORTED:
      return "not supported";
    case RSSTAB_ERROR_CORRUPT_DATA:
      return "damaged data";
    case RSSTAB_ERROR_IO:
      return "reading or writing failed";
    case RSSTAB_ERROR_UNTRUSTWORTHY:
      return "not determined by the data";
    case RSSTAB_ERROR_CANCELLED:
      return "stopped";
    case RSSTAB_ERROR_INTERNAL:
      return "internal error";
    case RSSTAB_ERROR_OUT_OF_MEMORY:
      return "out of memory";
    case RSSTAB_ERROR_BAD_STATE:
      return "not possible now";
  }
  return "unknown status";
}

size_t rsstab_option_count(void) {
  try {
    return rsstab::pipeline::OnlineOptionTable().size();
  } catch (...) {
    return 0;
  }
}

const char* rsstab_option_text(size_t index, rsstab_option_field field) {
  try {
    const auto& table = rsstab::pipeline::OnlineOptionTable();
    if (index >= table.size()) {
      return nullptr;
    }
    const auto& spec = table[index];
    switch (field) {
      case RSSTAB_OPTION_NAME:
        return spec.name.c_str();
      case RSSTAB_OPTION_VALUES:
        return spec.value_name.c_str();
      case RSSTAB_OPTION_RANGE:
        return spec.range.c_str();
      case RSSTAB_OPTION_HELP:
        return spec.help.c_str();
      case RSSTAB_OPTION_GROUP:
        return spec.group.c_str();
      case RSSTAB_OPTION_DEFAULT:
        return OptionDefaults()[index].c_str();
    }
  } catch (...) {
    return nullptr;
  }
  return nullptr;
}

rsstab_options* rsstab_options_create(void) {
  try {
    return new rsstab_options;
  } catch (...) {
    return nullptr;
  }
}

void rsstab_options_destroy(rsstab_options* options) { delete options; }

rsstab_status rsstab_options_set(rsstab_options* options, const char* name, const char* value) {
  return Guarded(options, [&]() -> Reply {
    if (name == nullptr || value == nullptr) {
      return NullArgument(name == nullptr ? "the option's name" : "the option's value");
    }
    return rsstab::capi::SetOption(options->values, name, value);
  });
}

const char* rsstab_options_get(rsstab_options* options, const char* name) {
  const rsstab_status status = Guarded(options, [&]() -> Reply {
    if (name == nullptr) {
      return NullArgument("the option's name");
    }
    for (const auto& spec : rsstab::pipeline::OnlineOptionTable()) {
      if (spec.name == name) {
        options->answer = spec.get(options->values);
        return RSSTAB_OK;
      }
    }
    return {RSSTAB_ERROR_NOT_FOUND, "there is no option '" + std::string(name) + "'"};
  });
  return status == RSSTAB_OK ? options->answer.c_str() : nullptr;
}

const char* rsstab_options_error(const rsstab_options* options) {
  return options != nullptr ? options->last_text.c_str() : "no options (NULL)";
}

rsstab_status rsstab_options_set_log(rsstab_options* options, rsstab_log_function log, void* user,
                                     rsstab_log_level most_detailed) {
  return Guarded(options, [&]() -> Reply {
    options->log = {log, user, most_detailed};
    return RSSTAB_OK;
  });
}

rsstab_status rsstab_create_live(rsstab_options* options, const rsstab_video* video,
                                 rsstab_instance** instance) {
  return Create(options, video, "", rsstab::capi::MakeLiveInstance, instance);
}

rsstab_status rsstab_create_analyze(rsstab_options* options, const rsstab_video* video,
                                    const char* path, rsstab_instance** instance) {
  return Create(options, video, path, rsstab::capi::MakeAnalyzeInstance, instance);
}

rsstab_status rsstab_create_apply(rsstab_options* options, const rsstab_video* video,
                                  const char* path, rsstab_instance** instance) {
  return Create(options, video, path, rsstab::capi::MakeApplyInstance, instance);
}

void rsstab_destroy(rsstab_instance* instance) { delete instance; }

const char* rsstab_error(const rsstab_instance* instance) {
  return instance != nullptr ? instance->last_text.c_str() : "no instance (NULL)";
}

int32_t rsstab_delay(const rsstab_instance* instance) {
  return instance != nullptr ? instance->mode->Delay() : 0;
}

rsstab_status rsstab_push(rsstab_instance* instance, const rsstab_picture* picture, int64_t pts,
                          void* frame_data, rsstab_release_function release) {
  return Guarded(instance, [&]() -> Reply {
    if (picture == nullptr) {
      return NullArgument("the picture");
    }
    return instance->mode->Push({picture, pts, frame_data, release});
  });
}

rsstab_status rsstab_peek(rsstab_instance* instance, int64_t* pts, void** frame_data) {
  return Guarded(instance, [&]() -> Reply {
    NextFrame next;
    Reply reply = instance->mode->Peek(next);
    if (reply.status == RSSTAB_OK) {
      Report(next, pts, frame_data);
    }
    return reply;
  });
}

rsstab_status rsstab_pull(rsstab_instance* instance, const rsstab_buffer* buffer, int64_t* pts,
                          void** frame_data) {
  return Guarded(instance, [&]() -> Reply {
    if (buffer == nullptr) {
      return NullArgument("the buffer");
    }
    NextFrame next;
    Reply reply = instance->mode->Pull(*buffer, next);
    if (reply.status == RSSTAB_OK || reply.status == RSSTAB_UNCHANGED) {
      Report(next, pts, frame_data);
    }
    return reply;
  });
}

rsstab_status rsstab_flush(rsstab_instance* instance) {
  return Guarded(instance, [&] { return instance->mode->Flush(); });
}

rsstab_status rsstab_render(rsstab_instance* instance, const rsstab_picture* picture, int64_t pts,
                            const rsstab_buffer* buffer) {
  return Guarded(instance, [&]() -> Reply {
    if (picture == nullptr || buffer == nullptr) {
      return NullArgument(picture == nullptr ? "the picture" : "the buffer");
    }
    return instance->mode->Render(*picture, pts, *buffer);
  });
}

rsstab_status rsstab_frame_time(rsstab_instance* instance, int64_t index, int64_t* pts) {
  return Guarded(instance, [&]() -> Reply {
    if (pts == nullptr) {
      return NullArgument("the place for the time");
    }
    return instance->mode->FrameTime(index, *pts);
  });
}

rsstab_status rsstab_reset(rsstab_instance* instance) {
  return Guarded(instance, [&] { return instance->mode->Reset(); });
}

rsstab_status rsstab_set(rsstab_instance* instance, const char* name, const char* value) {
  return Guarded(instance, [&]() -> Reply {
    if (name == nullptr || value == nullptr) {
      return NullArgument(name == nullptr ? "the option's name" : "the option's value");
    }
    return instance->mode->Set(name, value);
  });
}

}  // extern "C"
