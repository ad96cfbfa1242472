// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_measure.h"

#include <memory>
#include <string>

#include <fmt/format.h>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/app/measurement_run.h"
#include "moiregauge/app/run_figures.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/json_progress.h"
#include "moiregauge/cli/common/shared_options.h"
#include "moiregauge/cli/common/stage_display.h"
#include "moiregauge/cli/measure/summary_text.h"

namespace moiregauge::internal::cli {
namespace {

tl::expected<RunRequest, UsageError> request_of(const MeasureArgs& args) {
  RunRequest request;
  auto options = parse_measure_options(args);
  if (!options) return tl::unexpected(options.error());
  request.options = *std::move(options);
  auto figures = figure_formats(args.figures);
  if (!figures) return tl::unexpected(figures.error());
  request.figures = *std::move(figures);
  request.input = args.input;
  request.input_options = {args.fps, args.slow_motion, args.sequence, args.threads, args.max_pixels};
  request.output = args.output.empty() ? default_output(args.input) : args.output;
  request.earlier = args.resume ? Earlier::kResume : args.restart ? Earlier::kRestart : Earlier::kAsk;
  request.stabilised = args.stabilised;
  request.video = args.video;
  request.video_exaggeration = args.exaggeration;
  return request;
}

tl::expected<FinishedRun, RunFailure> run_shown(const RunRequest& request, bool quiet, const std::string& progress) {
  const InterruptGuard guard;
  if (!progress.empty()) {
    JsonProgress lines(JsonProgress::Samples::kProvisional);
    return run_measurement(request, lines.callbacks());
  }
  StageDisplay display(quiet);
  return run_measurement(request, display.callbacks());
}

int run(const MeasureArgs& args, const std::string& progress) {
  const auto request = request_of(args);
  if (!request) return fail(Exit::kUsage, request.error().message);
  const auto finished = run_shown(*request, args.quiet, progress);
  if (!finished) return fail(finished.error().exit, finished.error().message);
  const Measurement& measured = finished->measurement;
  const int exit = report(measured, request->options, {args.input, finished->folder, args.quiet, args.json});
  if (finished->trouble) return fail(finished->trouble->exit, finished->trouble->message);
  if (!measured.interrupted) return exit;
  return fail(Exit::kInterrupted,
              fmt::format("stopped at frame {}: the results so far are in {}: continue with --resume",
                          measured.observations.back().frame, finished->folder));
}

void add_input(CLI::App& command, MeasureArgs& args) {
  command.add_option("INPUT", args.input, "video, folder of images, multi-page TIFF, or printf pattern (--sequence)")
      ->type_name("FILE")
      ->required();
}

}  // namespace

void add_print_options(CLI::App& command, MeasureArgs& args) {
  command.add_option("--site", args.site, "site.toml, the markers and their positions")->type_name("FILE");
  command.add_option("--pitch", args.pitch, "grating pitch with its unit, e.g. 10mm (without a site file)")
      ->type_name("LENGTH");
  command
      .add_option("--axes", args.axes,
                  "direction of x without a site file: print (the references' gratings) or image [print]")
      ->type_name("print|image");
  add_print_scale(command, args.print_scale);
  add_marker_choice(command, args.choice);
}

void add_camera_options(CLI::App& command, MeasureArgs& args) {
  command.add_option("--camera", args.camera, "calibrated camera: TOML or OpenCV/ROS YAML")->type_name("FILE");
  command
      .add_option("--tone", args.tone,
                  "tone curve of the grey levels: auto (from the input or the gratings), linear, srgb, bt709, hlg, pq "
                  "or gamma:2.2 [auto]")
      ->type_name("auto|linear|srgb|bt709|gamma:G");
  command
      .add_option("--readout", args.readout,
                  "rolling shutter: time from the first row to the last, e.g. 18ms; 0ms: global [from the footage]")
      ->type_name("TIME");
}

void add_frame_options(CLI::App& command, MeasureArgs& args) {
  command.add_option("--fps", args.fps, "frames per second of a folder of images")->type_name("N");
  add_slow_motion(command, args.slow_motion);
  command.add_option("--reference-frame", args.reference_frame, "frame of zero displacement [first measurable frame]")
      ->type_name("N");
  command
      .add_option("--frames", args.frames,
                  "only these frames, half open: A:B or A:B:STEP, also in seconds, e.g. 1.5s:3s")
      ->type_name("A:B:STEP");
  command
      .add_option("--zero", args.zero,
                  "zero is the mean over these ok frames, half open: A:B [the reference frame alone]")
      ->type_name("A:B");
  command.add_option("--rest", args.rest, "frames in which no target moves, half open: A:B, or seconds, e.g. 0s:2s")
      ->type_name("A:B");
}

void add_method_options(CLI::App& command, MeasureArgs& args) {
  std::string methods;
  for (const Method& method : kMethods) methods += fmt::format("\n  {}: {}", method.name, method.summary);
  command.add_option("--method", args.method, "method [" + std::string(kDefaultMethod) + "]" + methods)
      ->type_name("conventional|two-stage|precise");
  command
      .add_option("--template", args.template_use,
                  "harmonics of the template in precise: on, off (u is wide for binary gratings) or auto [auto]")
      ->type_name("on|off|auto");
  command.add_option("--threads", args.threads, "threads to use; the results do not depend on it")
      ->check(CLI::Range(0, 1024).description(""))
      ->type_name("N");
  add_max_pixels(command, args.max_pixels);
}

void add_drawing_options(CLI::App& command, MeasureArgs& args) {
  add_figures(command, args.figures);
  command.add_flag("--video", args.video,
                   "also draw stabilised.mp4: the recording, and next to it the scene without camera motion");
  command
      .add_option("--exaggerate", args.exaggeration, "factor on the targets' motion in the video [chosen to show it]")
      ->type_name("N");
}

namespace {

void add_output(CLI::App& command, MeasureArgs& args) {
  command.add_flag("--sequence", args.sequence, "INPUT is a printf pattern such as shot%04d.png");
  command.add_option("-o,--out", args.output, "output folder [<input>-moiregauge]")->type_name("DIR");
  command
      .add_option("--stabilised", args.stabilised,
                  "also write every marker frame by frame, without the camera's motion")
      ->type_name("DIR");
  command.add_flag("--resume", args.resume, "continue an unfinished run, if there is one");
  command.add_flag("--restart", args.restart, "delete an unfinished run, if there is one");
  command.add_flag("--quiet", args.quiet, "print nothing but errors");
  command.add_flag("--json", args.json, "print run.json on stdout");
}

}  // namespace

void add_measure(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("measure", "Measure displacement in millimetres from a video or images");
  auto args = std::make_shared<MeasureArgs>();
  for (const auto add : {add_input, add_print_options, add_camera_options, add_frame_options, add_method_options,
                         add_drawing_options, add_output})
    add(*command, *args);
  const auto progress = std::make_shared<std::string>();
  add_progress(*command, *progress);
  command->callback([args, progress, &exit_code] { exit_code = run(*args, *progress); });
}

}  // namespace moiregauge::internal::cli
