// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_RESULT_H_
#define RSSTAB_IGF_BASE_RESULT_H_

#include <spdlog/fmt/fmt.h>

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace rsstab {

// Why something failed, coarse enough for a program to branch on.
enum class ErrorCode {
  kInvalidArgument,  // the caller asked for something that makes no sense
  kNotFound,         // a file, stream or encoder is not there
  kUnsupported,      // valid, but this program cannot do it
  kCorruptData,      // the input breaks its own format
  kIo,               // reading or writing failed (full disk, no permission)
  kUntrustworthy,    // an estimate exists, but the data do not determine it
  kCancelled,        // the user or host asked to stop
  kInternal,         // our own bug
};

// `message` is one or more sentences: what was wrong, where (file, frame, byte), what to do next.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
};

// The one way a module reports failure. Libraries neither print nor throw across their headers.
template <typename T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

// Fail(ErrorCode::kIo, "{}: disk is full", path)
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> Fail(ErrorCode code, fmt::format_string<Args...> format,
                                         Args&&... args) {
  return tl::unexpected<Error>(Error{code, fmt::format(format, std::forward<Args>(args)...)});
}

// Passes an error up unchanged; the first cause is kept.
[[nodiscard]] inline tl::unexpected<Error> Propagate(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

// Passes an error up with the place in front of it: "<where>: <first cause>".
[[nodiscard]] inline tl::unexpected<Error> Propagate(Error error, const std::string& where) {
  error.message = where + ": " + error.message;
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_RESULT_H_
