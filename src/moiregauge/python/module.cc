// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/python/bindings.h"
#include "moiregauge/python/errors.h"
#include "moiregauge/version.h"

PYBIND11_MODULE(_core, module) {
  using namespace moiregauge::python;
  module.doc() = "The library moiregauge. Import the package moiregauge instead.";
  module.attr("__version__") = moiregauge::kVersion;
  add_errors(module);
  add_site(module);
  add_run(module);
  add_image(module);
  add_tracker(module);
}
