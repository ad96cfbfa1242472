// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include <pybind11/stl.h>

#include "moiregauge/python/bindings.h"
#include "moiregauge/python/errors.h"
#include "moiregauge/python/numpy_image.h"
#include "moiregauge/run.h"
#include "moiregauge/sampling_moire.h"

namespace moiregauge::python {
namespace {

Axis axis_named(const std::string& name) {
  if (name != "x" && name != "y")
    raise({ErrorKind::kUsage, "the axis is unknown: axis=" + name + ": choose \"x\" or \"y\""});
  return name == "x" ? Axis::kX : Axis::kY;
}

py::array map_view(const py::object& self, std::vector<double> PhaseMap::*values) {
  const auto& map = self.cast<const PhaseMap&>();
  const py::array flat = vector_view<double>(self, map.*values);
  return flat.attr("reshape")(map.height, map.width);
}

void add_phase(py::module_& module) {
  py::class_<FringePhase>(module, "FringePhase", "Mean phase of a grating over a region.")
      .def_readonly("phase_rad", &FringePhase::phase_rad)
      .def_readonly("u_rad", &FringePhase::u_rad)
      .def_readonly("modulation", &FringePhase::modulation)
      .def_readonly("is_valid", &FringePhase::is_valid);
  py::class_<PhaseMap, std::shared_ptr<PhaseMap>>(module, "PhaseMap", "Phase of a grating, pixel by pixel.")
      .def_readonly("margin", &PhaseMap::margin)
      .def_property_readonly("phase_rad", [](const py::object& self) { return map_view(self, &PhaseMap::phase_rad); })
      .def_property_readonly("modulation",
                             [](const py::object& self) { return map_view(self, &PhaseMap::modulation); });
  module.def(
      "sampling_moire",
      [](const py::array& image, const std::string& axis, double pitch_px, int region_px, double noise_grey) {
        const ImageView view = image_of(image, 0);
        const Axis along = axis_named(axis);
        const py::gil_scoped_release release;
        return sampling_moire(view, along, pitch_px, region_px, noise_grey);
      },
      py::arg("image"), py::arg("axis"), py::arg("pitch_px"), py::arg("region_px"), py::arg("noise_grey"));
  module.def(
      "phase_map",
      [](const py::array& image, const std::string& axis, double pitch_px) {
        const ImageView view = image_of(image, 0);
        const Axis along = axis_named(axis);
        const py::gil_scoped_release release;
        return std::make_shared<PhaseMap>(phase_map(view, along, pitch_px));
      },
      py::arg("image"), py::arg("axis"), py::arg("pitch_px"));
  module.def("displacement_px", &displacement_px, py::arg("reference"), py::arg("current"), py::arg("pitch_px"));
}

}  // namespace

void add_image(py::module_& module) {
  add_phase(module);
  py::class_<InspectOptions> options(module, "InspectOptions");
  options.def(py::init<>());
  options.def_property(
      "pitch_mm", [](const InspectOptions& o) { return o.pitch ? std::optional(o.pitch->value()) : std::nullopt; },
      [](InspectOptions& o, std::optional<double> mm) {
        o.pitch = mm ? std::optional(Millimetres(*mm)) : std::nullopt;
      });
  options.def_readwrite("site", &InspectOptions::site).def_readwrite("site_file", &InspectOptions::site_file);
  options.def_readwrite("camera_file", &InspectOptions::camera_file).def_readwrite("frame", &InspectOptions::frame);
  options.def_readwrite("fps", &InspectOptions::fps);
  py::class_<InspectedMarker>(module, "InspectedMarker", "Marker of an image.")
      .def_readonly("name", &InspectedMarker::name)
      .def_readonly("is_reference", &InspectedMarker::is_reference)
      .def_readonly("x_px", &InspectedMarker::x_px)
      .def_readonly("y_px", &InspectedMarker::y_px)
      .def_readonly("x_mm", &InspectedMarker::x_mm)
      .def_readonly("y_mm", &InspectedMarker::y_mm)
      .def_readonly("pitch_px", &InspectedMarker::pitch_px)
      .def_readonly("u_dx_mm", &InspectedMarker::u_dx_mm)
      .def_readonly("u_dy_mm", &InspectedMarker::u_dy_mm);
  py::class_<Inspection, std::shared_ptr<Inspection>>(module, "Inspection")
      .def_readonly("width", &Inspection::width)
      .def_readonly("height", &Inspection::height)
      .def_readonly("circles", &Inspection::circles)
      .def_readonly("gratings", &Inspection::gratings)
      .def_readonly("markers", &Inspection::markers)
      .def_readonly("problem", &Inspection::problem)
      .def_readonly("mm_per_px", &Inspection::mm_per_px)
      .def_readonly("distance_from", &Inspection::from)
      .def_readonly("distance_to", &Inspection::to)
      .def_readonly("distance_mm", &Inspection::distance_mm)
      .def_readonly("warnings", &Inspection::warnings)
      .def_readonly("json", &Inspection::json)
      .def_property_readonly("overlay_png", [](const Inspection& inspection) {
        return py::bytes(reinterpret_cast<const char*>(inspection.overlay_png.data()), inspection.overlay_png.size());
      });
  module.def(
      "inspect_input",
      [](const std::string& input, const InspectOptions& how) {
        py::gil_scoped_release release;
        auto seen = inspect(input, how);
        py::gil_scoped_acquire lock;
        return std::make_shared<Inspection>(value_or_raise(std::move(seen)));
      },
      py::arg("input"), py::arg("options"));
  module.def(
      "inspect_image",
      [](const py::array& image, int bits, const InspectOptions& how) {
        const ImageView view = image_of(image, bits);
        py::gil_scoped_release release;
        auto seen = inspect(view, how);
        py::gil_scoped_acquire lock;
        return std::make_shared<Inspection>(value_or_raise(std::move(seen)));
      },
      py::arg("image"), py::arg("bits"), py::arg("options"));
}

}  // namespace moiregauge::python
