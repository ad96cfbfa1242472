// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/python/errors.h"

#include <array>

namespace moiregauge::python {
namespace {

struct Kind {
  ErrorKind kind;
  const char* name;
  PyObject* base;  // built-in exception that fits, or null
};

std::array<Kind, 5> kinds() {
  return {{{ErrorKind::kInternal, "InternalError", nullptr},
           {ErrorKind::kUsage, "UsageError", PyExc_ValueError},
           {ErrorKind::kInput, "InputError", nullptr},
           {ErrorKind::kRefused, "RefusedError", nullptr},
           {ErrorKind::kOutput, "OutputError", nullptr}}};
}

py::module_ core() { return py::module_::import("moiregauge._core"); }

}  // namespace

void add_errors(py::module_& module) {
  const auto add = [&](const char* name, const py::object& bases) {
    const std::string full = std::string("moiregauge.") + name;
    auto type = py::reinterpret_steal<py::object>(PyErr_NewException(full.c_str(), bases.ptr(), nullptr));
    if (!type) throw py::error_already_set();
    module.attr(name) = type;
    return type;
  };
  const py::object error = add("Error", py::reinterpret_borrow<py::object>(PyExc_Exception));
  for (const Kind& kind : kinds()) {
    py::object bases = error;
    if (kind.base != nullptr) bases = py::make_tuple(error, py::reinterpret_borrow<py::object>(kind.base));
    add(kind.name, bases).attr("exit_code") = static_cast<int>(kind.kind);
  }
}

void raise(const Error& error) {
  for (const Kind& kind : kinds()) {
    if (kind.kind != error.kind) continue;
    PyErr_SetString(py::object(core().attr(kind.name)).ptr(), error.message.c_str());
    throw py::error_already_set();
  }
  throw std::runtime_error(error.message);
}

}  // namespace moiregauge::python
