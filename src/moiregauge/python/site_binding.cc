// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "moiregauge/camera.h"
#include "moiregauge/measure.h"
#include "moiregauge/python/bindings.h"
#include "moiregauge/python/errors.h"
#include "moiregauge/site.h"
#include "moiregauge/units.h"

namespace moiregauge::python {
namespace {

std::optional<double> pitch_of(const Marker& marker) {
  return marker.grating ? std::optional(marker.grating->pitch_mm) : std::nullopt;
}

double x_of(const Marker& marker) { return marker.grating ? marker.grating->x_mm : marker.circle->x_mm; }
double y_of(const Marker& marker) { return marker.grating ? marker.grating->y_mm : marker.circle->y_mm; }

void add_camera(py::module_& module) {
  py::class_<Camera> camera(module, "Camera", "Pinhole camera with the lens model and the signs of OpenCV, in pixels.");
  camera.def(py::init<>());
  camera.def_readwrite("width", &Camera::width).def_readwrite("height", &Camera::height);
  camera.def_readwrite("fx", &Camera::fx).def_readwrite("fy", &Camera::fy);
  camera.def_readwrite("cx", &Camera::cx).def_readwrite("cy", &Camera::cy);
  camera.def_readwrite("k1", &Camera::k1).def_readwrite("k2", &Camera::k2).def_readwrite("k3", &Camera::k3);
  camera.def_readwrite("p1", &Camera::p1).def_readwrite("p2", &Camera::p2);
  camera.def("__repr__", [](const Camera& c) {
    return py::str("Camera(width={}, height={}, fx={:.2f}, fy={:.2f}, cx={:.2f}, cy={:.2f}, k1={:.6g}, k2={:.6g})")
        .format(c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2);
  });
  module.def(
      "read_camera", [](const std::string& path) { return value_or_raise(read_camera(path)); }, py::arg("path"));
}

}  // namespace

void add_site(py::module_& module) {
  add_camera(module);
  py::class_<Marker>(module, "Marker", "What is printed at one place of the site.")
      .def_readonly("name", &Marker::name)
      .def_readonly("is_reference", &Marker::is_reference)
      .def_readonly("z_mm", &Marker::z_mm)
      .def_property_readonly("x_mm", &x_of)
      .def_property_readonly("y_mm", &y_of)
      .def_property_readonly("pitch_mm", &pitch_of)
      .def("__repr__", [](const Marker& marker) {
        return py::str("Marker({!r}, is_reference={}, x_mm={:.6g}, y_mm={:.6g})")
            .format(marker.name, marker.is_reference, x_of(marker), y_of(marker));
      });
  py::class_<Site>(module, "Site", "What is printed where, in millimetres on the board.")
      .def_readonly("markers", &Site::markers)
      .def_property_readonly("text", &site_text, "The text of a site file.");
  module.def(
      "read_site", [](const std::string& path) { return value_or_raise(read_site(path)); }, py::arg("path"));
  module.def(
      "read_length_mm", [](const std::string& text) { return value_or_raise(read_length(text)).value(); },
      py::arg("text"));
  module.def(
      "read_duration_s", [](const std::string& text) { return value_or_raise(read_duration(text)).value(); },
      py::arg("text"));
  py::class_<FrameRange>(module, "FrameRange", "Frames or times of a recording.");
  module.def(
      "read_frame_range",
      [](const std::string& text, const std::string& option) { return value_or_raise(read_frame_range(text, option)); },
      py::arg("text"), py::arg("option"));
}

}  // namespace moiregauge::python
