// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/python/progress_hook.h"

#include <utility>

namespace moiregauge::python {

bool ProgressHook::operator()(long done, long expected) {
  constexpr std::chrono::milliseconds kInterval{50};  // a key press feels immediate; chosen
  const auto now = Clock::now();
  if (last_ && now - *last_ < kInterval && done != expected) return true;
  last_ = now;
  const py::gil_scoped_acquire lock;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return callback_.is_none() || !callback_(done, expected).is(py::bool_(false));
  } catch (py::error_already_set& error) {
    error_.emplace(std::move(error));
    return false;
  }
}

void ProgressHook::raise_if_stopped() {
  if (!error_) return;
  py::error_already_set error = std::move(*error_);
  error_.reset();
  throw error;
}

}  // namespace moiregauge::python
