// SPDX-License-Identifier: Apache-2.0
// Ownership of GLib's objects and errors.
#pragma once

#include <memory>
#include <string>

#include <arv.h>

namespace moiregauge::internal {

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};
template <typename Object>
using GlibObject = std::unique_ptr<Object, Unref>;

// Receives the error of a call. Each use of out() forgets the previous error.
class GlibError {
 public:
  GlibError() = default;
  GlibError(const GlibError&) = delete;
  GlibError& operator=(const GlibError&) = delete;
  ~GlibError() { g_clear_error(&error_); }
  [[nodiscard]] GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const { return error_ != nullptr; }
  [[nodiscard]] std::string text() const { return error_ == nullptr ? "" : error_->message; }

 private:
  GError* error_ = nullptr;
};

[[nodiscard]] inline std::string text_or_empty(const char* text) { return text == nullptr ? "" : text; }

}  // namespace moiregauge::internal
