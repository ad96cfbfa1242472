// SPDX-License-Identifier: Apache-2.0
// Errors of the library as Python exceptions with the same words.
#pragma once

#include <utility>

#include <pybind11/pybind11.h>

#include "moiregauge/errors.h"

namespace moiregauge::python {

namespace py = pybind11;

// Creates moiregauge.Error and one class per kind.
void add_errors(py::module_& module);

// Throws the exception of the error's kind.
[[noreturn]] void raise(const Error& error);

// Returns the value, or throws the exception of the error.
template <typename Value>
Value value_or_raise(Expected<Value>&& expected) {
  if (!expected) raise(expected.error());
  if constexpr (!std::is_void_v<Value>) return *std::move(expected);
}

}  // namespace moiregauge::python
