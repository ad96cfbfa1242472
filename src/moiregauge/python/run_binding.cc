// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include "moiregauge/measure.h"
#include "moiregauge/python/bindings.h"
#include "moiregauge/python/errors.h"
#include "moiregauge/python/numpy_image.h"
#include "moiregauge/python/progress_hook.h"
#include "moiregauge/run.h"

namespace moiregauge::python {
namespace {

using Shared = std::shared_ptr<Result>;

// Property of an optional quantity as a number in its unit.
template <typename Options, typename Value>
void def_quantity(py::class_<Options>& type, const char* name, std::optional<Value> Options::*member) {
  type.def_property(
      name,
      [member](const Options& options) {
        const auto& value = options.*member;
        return value ? std::optional(value->value()) : std::nullopt;
      },
      [member](Options& options, std::optional<double> number) {
        options.*member = number ? std::optional(Value(*number)) : std::nullopt;
      });
}

template <typename Shown, typename Field>
auto column(const Field Sample::*field) {
  return [field](const py::object& self) { return field_view<Shown>(self, self.cast<const Target&>().samples, field); };
}

void add_results(py::module_& module) {
  static_assert(sizeof(Status) == sizeof(std::int32_t));
  py::class_<Target>(module, "Target", "Displacement of one target, one row per frame. Not measured is NaN.")
      .def_readonly("name", &Target::name)
      .def_readonly("ok", &Target::ok)
      .def_readonly("rms_u_dx", &Target::u_dx_mm)
      .def_readonly("rms_u_dy", &Target::u_dy_mm)
      .def_property_readonly("frame", column<long>(&Sample::frame))
      .def_property_readonly("time", column<double>(&Sample::time_s))
      .def_property_readonly("dx", column<double>(&Sample::dx_mm))
      .def_property_readonly("dy", column<double>(&Sample::dy_mm))
      .def_property_readonly("u_dx", column<double>(&Sample::u_dx_mm))
      .def_property_readonly("u_dy", column<double>(&Sample::u_dy_mm))
      .def_property_readonly("status", column<std::int32_t>(&Sample::status))
      .def("__len__", [](const Target& target) { return target.samples.size(); });
  py::class_<Result, Shared>(module, "Result")
      .def_readonly("targets", &Result::targets)
      .def_readonly("site", &Result::site)
      .def_readonly("camera", &Result::camera)
      .def_readonly("reference_frame", &Result::reference_frame)
      .def_readonly("references_verified", &Result::references_verified)
      .def_readonly("warnings", &Result::warnings)
      .def_readonly("refusal", &Result::refusal)
      .def_readonly("remedy", &Result::remedy)
      .def_readonly("exit_code", &Result::exit_code)
      .def_readonly("folder", &Result::folder);
  module.def("status_word", [](int code) {
    if (code < 0 || code > static_cast<int>(Status::kTooCoarse)) throw py::index_error("no such status");
    return to_string(static_cast<Status>(code));
  });
}

void add_options(py::module_& module) {
  py::class_<MeasureOptions> measure(module, "MeasureOptions");
  measure.def(py::init<>());
  def_quantity(measure, "pitch_mm", &MeasureOptions::pitch);
  def_quantity(measure, "readout_s", &MeasureOptions::readout);
  measure.def_readwrite("site", &MeasureOptions::site).def_readwrite("site_file", &MeasureOptions::site_file);
  measure.def_readwrite("camera", &MeasureOptions::camera).def_readwrite("camera_file", &MeasureOptions::camera_file);
  measure.def_readwrite("method", &MeasureOptions::method).def_readwrite("tone", &MeasureOptions::tone);
  measure.def_readwrite("fps", &MeasureOptions::fps).def_readwrite("slow_motion", &MeasureOptions::slow_motion);
  measure.def_readwrite("frames", &MeasureOptions::frames).def_readwrite("rest", &MeasureOptions::rest);
  measure.def_readwrite("zero", &MeasureOptions::zero).def_readwrite("threads", &MeasureOptions::threads);
  measure.def_readwrite("reference_frame", &MeasureOptions::reference_frame);
  measure.def_readwrite("output", &MeasureOptions::output)
      .def_property(
          "resumes", [](const MeasureOptions& o) { return o.unfinished == Unfinished::kResume; },
          [](MeasureOptions& o, bool is_set) { o.unfinished = is_set ? Unfinished::kResume : Unfinished::kRefuse; });
  measure.def_property(
      "restarts", [](const MeasureOptions& o) { return o.unfinished == Unfinished::kRestart; },
      [](MeasureOptions& o, bool is_set) { o.unfinished = is_set ? Unfinished::kRestart : Unfinished::kRefuse; });
  py::class_<SolveOptions> solve(module, "SolveOptions");
  solve.def(py::init<>());
  solve.def_readwrite("site", &SolveOptions::site).def_readwrite("site_file", &SolveOptions::site_file);
  solve.def_readwrite("camera", &SolveOptions::camera).def_readwrite("camera_file", &SolveOptions::camera_file);
  solve.def_readwrite("method", &SolveOptions::method).def_readwrite("fps", &SolveOptions::fps);
  solve.def_readwrite("rest", &SolveOptions::rest).def_readwrite("has_rest", &SolveOptions::has_rest);
  solve.def_readwrite("zero", &SolveOptions::zero).def_readwrite("has_zero", &SolveOptions::has_zero);
  def_quantity(solve, "readout_s", &SolveOptions::readout);
  solve.def_readwrite("output", &SolveOptions::output);
  py::class_<DeriveOptions> derive(module, "DeriveOptions");
  derive.def(py::init<>());
  derive.def_readwrite("channels", &DeriveOptions::channels).def_readwrite("layers", &DeriveOptions::layers);
  derive.def_readwrite("solved", &DeriveOptions::solved).def_readwrite("output", &DeriveOptions::output);
}

// Runs work without the interpreter's lock.
template <typename Work>
auto unlocked(const Work& work) {
  const py::gil_scoped_release release;
  return work();
}

Shared measure_input(const std::string& input, MeasureOptions options, const py::object& on_progress) {
  ProgressHook hook(on_progress);
  options.on_progress = [&hook](long done, long expected) { return hook(done, expected); };
  auto result = unlocked([&] { return measure(input, options); });
  hook.raise_if_stopped();
  return std::make_shared<Result>(value_or_raise(std::move(result)));
}

void add_channels(py::module_& module) {
  py::class_<DerivedChannel>(module, "DerivedChannel", "Series of one derived channel. Not measured is NaN.")
      .def_readonly("name", &DerivedChannel::name)
      .def_readonly("unit", &DerivedChannel::unit)
      .def_readonly("expression", &DerivedChannel::expression)
      .def_readonly("mean", &DerivedChannel::mean)
      .def_readonly("u_mean", &DerivedChannel::u_mean)
      .def_readonly("rms", &DerivedChannel::rms)
      .def_readonly("u_rms", &DerivedChannel::u_rms)
      .def_readonly("peak_to_peak", &DerivedChannel::peak_to_peak)
      .def_readonly("u_peak_to_peak", &DerivedChannel::u_peak_to_peak)
      .def_property_readonly(
          "value",
          [](const py::object& self) { return vector_view<double>(self, self.cast<const DerivedChannel&>().value); })
      .def_property_readonly(
          "u", [](const py::object& self) { return vector_view<double>(self, self.cast<const DerivedChannel&>().u); })
      .def_property_readonly("status", [](const py::object& self) {
        return vector_view<std::int32_t>(self, self.cast<const DerivedChannel&>().status);
      });
  py::class_<DerivedChannels, std::shared_ptr<DerivedChannels>>(module, "DerivedChannels")
      .def_readonly("channels", &DerivedChannels::channels)
      .def_readonly("warnings", &DerivedChannels::warnings)
      .def_property_readonly(
          "frame",
          [](const py::object& self) { return vector_view<long>(self, self.cast<const DerivedChannels&>().frame); })
      .def_property_readonly("time", [](const py::object& self) {
        return vector_view<double>(self, self.cast<const DerivedChannels&>().time_s);
      });
}

}  // namespace

void add_run(py::module_& module) {
  add_results(module);
  add_options(module);
  add_channels(module);
  module.def("measure", &measure_input, py::arg("input"), py::arg("options"), py::arg("on_progress"));
  module.def(
      "read_run",
      [](const std::string& run, const SolveOptions& known) {
        return std::make_shared<Result>(value_or_raise(unlocked([&] { return read_run(run, known); })));
      },
      py::arg("run"), py::arg("known"));
  module.def(
      "solve",
      [](const std::string& run, const SolveOptions& options) {
        return std::make_shared<Result>(value_or_raise(unlocked([&] { return solve(run, options); })));
      },
      py::arg("run"), py::arg("options"));
  module.def(
      "derive",
      [](const std::string& run, const DeriveOptions& options) {
        return std::make_shared<DerivedChannels>(value_or_raise(unlocked([&] { return derive(run, options); })));
      },
      py::arg("run"), py::arg("options"));
  module.def(
      "write_report", [](const std::string& run, const std::string& file) { value_or_raise(write_report(run, file)); },
      py::arg("run"), py::arg("file"));
}

}  // namespace moiregauge::python
