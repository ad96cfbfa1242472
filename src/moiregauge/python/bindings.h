// SPDX-License-Identifier: Apache-2.0
// Parts of the Python module moiregauge._core. The package moiregauge (Python) is what users import.
#pragma once

#include <pybind11/pybind11.h>

namespace moiregauge::python {

namespace py = pybind11;

void add_site(py::module_& module);     // Camera, Marker, Site, quantities as text
void add_run(py::module_& module);      // Sample, Target, Result, MeasureOptions, measure, solve, derive, reports
void add_image(py::module_& module);    // inspect, sampling moiré
void add_tracker(py::module_& module);  // Tracker, Simulation

}  // namespace moiregauge::python
