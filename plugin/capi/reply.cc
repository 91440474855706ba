// SPDX-License-Identifier: Apache-2.0
#include "plugin/capi/reply.h"

namespace rsstab::capi {
namespace {

rsstab_status StatusOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return RSSTAB_ERROR_INVALID_ARGUMENT;
    case ErrorCode::kNotFound:
      return RSSTAB_ERROR_NOT_FOUND;
    case ErrorCode::kUnsupported:
      return RSSTAB_ERROR_UNSUPPORTED;
    case ErrorCode::kCorruptData:
      return RSSTAB_ERROR_CORRUPT_DATA;
    case ErrorCode::kIo:
      return RSSTAB_ERROR_IO;
    case ErrorCode::kUntrustworthy:
      return RSSTAB_ERROR_UNTRUSTWORTHY;
    case ErrorCode::kCancelled:
      return RSSTAB_ERROR_CANCELLED;
    case ErrorCode::kInternal:
      break;
  }
  return RSSTAB_ERROR_INTERNAL;
}

}  // namespace

Reply::Reply(Error error) : status(StatusOf(error.code)), text(std::move(error.message)) {}

Reply::Reply(Status result) {
  if (!result) {
    *this = Reply(std::move(result.error()));
  }
}

}  // namespace rsstab::capi
