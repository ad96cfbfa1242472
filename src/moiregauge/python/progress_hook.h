// SPDX-License-Identifier: Apache-2.0
// Progress of long work for Python: calls back, and lets Ctrl-C stop the work.
#pragma once

#include <chrono>
#include <optional>

#include <pybind11/pybind11.h>

namespace moiregauge::python {

namespace py = pybind11;

// Is called without the interpreter's lock, from one thread at a time. It takes the lock at the first call, after 50 ms,
// and for the last frame. Another Python thread may keep the lock for 5 ms, so taking it for each frame would be slow.
class ProgressHook {
 public:
  // `callback`: callable(done, expected), which stops the work by returning False, or None.
  explicit ProgressHook(py::object callback) : callback_(std::move(callback)) {}
  ProgressHook(const ProgressHook&) = delete;
  ProgressHook& operator=(const ProgressHook&) = delete;

  [[nodiscard]] bool operator()(long done, long expected);
  // Throws the exception that stopped the work, if any. Requires the lock.
  void raise_if_stopped();

 private:
  using Clock = std::chrono::steady_clock;
  py::object callback_;
  std::optional<Clock::time_point> last_;
  std::optional<py::error_already_set> error_;
};

}  // namespace moiregauge::python
