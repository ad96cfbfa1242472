// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <utility>

#include <pybind11/stl.h>

#include "moiregauge/python/bindings.h"
#include "moiregauge/python/errors.h"
#include "moiregauge/python/numpy_image.h"
#include "moiregauge/python/progress_hook.h"
#include "moiregauge/simulate.h"
#include "moiregauge/tracker.h"

namespace moiregauge::python {
namespace {

using Names = std::shared_ptr<const std::vector<std::string>>;

struct NamedFrame {
  TrackedFrame frame;
  Names names;  // targets, in the order of the samples

  [[nodiscard]] const Sample& at(const std::string& name) const {
    const auto found = std::find(names->begin(), names->end(), name);
    const auto index = static_cast<std::size_t>(found - names->begin());
    if (index >= frame.samples.size()) throw py::key_error(name);
    return frame.samples[index];
  }
};

// A tracker that threads may share: one frame at a time.
class SharedTracker {
  // Runs work on the tracker without the interpreter's lock.
  template <typename Work>
  auto locked(const Work& work) const {
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    return work();
  }

 public:
  explicit SharedTracker(const MeasureOptions& options) : tracker_(value_or_raise(Tracker::create(options))) {}

  NamedFrame update(const py::array& image, double time_s, int bits) {
    const ImageView view = image_of(image, bits);
    auto frame = [&] {
      const py::gil_scoped_release release;
      const std::scoped_lock lock(mutex_);
      auto measured = tracker_.update(view, time_s);
      if (names_->size() != tracker_.target_names().size())
        names_ = std::make_shared<const std::vector<std::string>>(tracker_.target_names());
      return std::pair(std::move(measured), names_);
    }();
    return {value_or_raise(std::move(frame.first)), std::move(frame.second)};
  }
  [[nodiscard]] std::vector<std::string> names() const {
    return locked([this] { return *names_; });
  }
  [[nodiscard]] long frames() const {
    return locked([this] { return tracker_.frames(); });
  }
  [[nodiscard]] std::vector<std::string> warnings() const {
    return locked([this] { return tracker_.warnings(); });
  }

 private:
  mutable std::mutex mutex_;
  Tracker tracker_;
  Names names_ = std::make_shared<const std::vector<std::string>>();
};

// Renders into arrays of Python. One frame at a time.
class SharedSimulation {
 public:
  SharedSimulation(const std::string& scenario, const SimulateOptions& options)
      : simulation_(value_or_raise(Simulation::load(scenario, options))) {}

  py::array frame(long number) {
    if (number < 0 || number >= simulation_.frames()) throw py::index_error("no such frame");
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    const ImageView view = simulation_.render(number);
    const py::gil_scoped_acquire acquire;
    return view.bits == 8 ? copied<std::uint8_t>(view) : copied<std::uint16_t>(view);
  }
  [[nodiscard]] std::optional<std::pair<double, double>> truth(long number, const std::string& marker) const {
    const auto truth = simulation_.truth(number, marker);
    return truth ? std::optional(std::pair(truth->dx_mm, truth->dy_mm)) : std::nullopt;
  }
  void write(const std::string& folder, const py::object& on_progress) const {
    ProgressHook hook(on_progress);
    auto written = [&] {
      const py::gil_scoped_release release;
      return simulation_.write(folder, [&hook](long done, long expected) { return hook(done, expected); });
    }();
    hook.raise_if_stopped();
    value_or_raise(std::move(written));
  }
  [[nodiscard]] const Simulation& simulation() const { return simulation_; }

 private:
  template <typename Grey>
  static py::array copied(const ImageView& view) {
    py::array_t<Grey> out({view.height, view.width});
    for (int y = 0; y < view.height; ++y)
      std::memcpy(out.mutable_data(y, 0), static_cast<const Grey*>(view.data) + y * view.stride,
                  static_cast<std::size_t>(view.width) * sizeof(Grey));
    return out;
  }

  std::mutex mutex_;
  Simulation simulation_;
};

void add_simulation(py::module_& module) {
  py::class_<SimulateOptions>(module, "SimulateOptions")
      .def(py::init<>())
      .def_readwrite("settings", &SimulateOptions::settings)
      .def_readwrite("seed", &SimulateOptions::seed)
      .def_readwrite("frames", &SimulateOptions::frames)
      .def_readwrite("markers_only", &SimulateOptions::markers_only)
      .def_readwrite("threads", &SimulateOptions::threads);
  py::class_<SharedSimulation>(module, "Simulation")
      .def(py::init<const std::string&, const SimulateOptions&>(), py::arg("scenario"), py::arg("options"))
      .def("frame", &SharedSimulation::frame, py::arg("number"))
      .def("truth", &SharedSimulation::truth, py::arg("number"), py::arg("marker"))
      .def("write", &SharedSimulation::write, py::arg("folder"), py::arg("on_progress"))
      .def_property_readonly("frames", [](const SharedSimulation& s) { return s.simulation().frames(); })
      .def_property_readonly("fps", [](const SharedSimulation& s) { return s.simulation().fps(); })
      .def_property_readonly("site", [](const SharedSimulation& s) { return s.simulation().site(); });
}

}  // namespace

void add_tracker(py::module_& module) {
  py::class_<Sample>(module, "Sample", "Displacement of one target in one frame. Not measured is NaN.")
      .def_readonly("frame", &Sample::frame)
      .def_readonly("time", &Sample::time_s)
      .def_readonly("dx", &Sample::dx_mm)
      .def_readonly("dy", &Sample::dy_mm)
      .def_readonly("u_dx", &Sample::u_dx_mm)
      .def_readonly("u_dy", &Sample::u_dy_mm)
      .def_property_readonly("status", [](const Sample& sample) { return std::string(to_string(sample.status)); });
  py::class_<NamedFrame>(module, "TrackedFrame", "Displacements of all targets in the latest frame.")
      .def_property_readonly("is_reference", [](const NamedFrame& frame) { return frame.frame.is_reference; })
      .def_property_readonly("problem", [](const NamedFrame& frame) { return frame.frame.problem; })
      .def_property_readonly("names", [](const NamedFrame& frame) { return *frame.names; })
      .def("__len__", [](const NamedFrame& frame) { return frame.frame.samples.size(); })
      .def("__getitem__", &NamedFrame::at, py::return_value_policy::reference_internal);
  py::class_<SharedTracker>(module, "Tracker")
      .def(py::init<const MeasureOptions&>(), py::arg("options"))
      .def("update", &SharedTracker::update, py::arg("image"), py::arg("time_s"), py::arg("bits"))
      .def_property_readonly("names", &SharedTracker::names)
      .def_property_readonly("frames", &SharedTracker::frames)
      .def_property_readonly("warnings", &SharedTracker::warnings);
  add_simulation(module);
}

}  // namespace moiregauge::python
