// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_CAPI_REPLY_H_
#define RSSTAB_PLUGIN_CAPI_REPLY_H_

#include <exception>
#include <new>
#include <string>
#include <utility>

#include "igf/base/result.h"
#include "plugin/capi/rsstab.h"

namespace rsstab::capi {

// What a call answers: a status, and the text that goes with it.
struct Reply {
  // NOLINTBEGIN(google-explicit-constructor): functions return either kind
  Reply(rsstab_status answer) : status(answer) {}
  Reply(Error error);
  Reply(Status result);
  // NOLINTEND(google-explicit-constructor)
  Reply(rsstab_status answer, std::string why) : status(answer), text(std::move(why)) {}

  rsstab_status status = RSSTAB_OK;
  std::string text;
};

// The text of an object's last call. Nothing here throws.
class LastText {
 public:
  void Set(std::string text) noexcept {
    text_ = std::move(text);
    fixed_ = nullptr;
  }
  // `text` outlives this.
  void SetFixed(const char* text) noexcept { fixed_ = text; }
  [[nodiscard]] const char* c_str() const noexcept {
    return fixed_ != nullptr ? fixed_ : text_.c_str();
  }

 private:
  std::string text_;
  const char* fixed_ = "";  // null: text_
};

// Runs `body`, which answers with a Reply, and lets nothing out but a status. `object->last_text`
// then tells why.
template <typename Object, typename Body>
[[nodiscard]] rsstab_status Guarded(Object* object, const Body& body) noexcept {
  if (object == nullptr) {
    return RSSTAB_ERROR_INVALID_ARGUMENT;
  }
  object->last_text.SetFixed("");
  try {
    Reply reply = body();
    object->last_text.Set(std::move(reply.text));
    return reply.status;
  } catch (const std::bad_alloc&) {
    object->last_text.SetFixed("out of memory");
    return RSSTAB_ERROR_OUT_OF_MEMORY;
  } catch (const std::exception& e) {
    try {
      object->last_text.Set(std::string("unexpected: ") + e.what());
    } catch (...) {
      object->last_text.SetFixed("unexpected failure");
    }
  } catch (...) {
    object->last_text.SetFixed("unexpected failure");
  }
  return RSSTAB_ERROR_INTERNAL;
}

}  // namespace rsstab::capi

#endif  // RSSTAB_PLUGIN_CAPI_REPLY_H_
