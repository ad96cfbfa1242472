// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_measure.h"

#include <algorithm>
#include <cstdio>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "moiregauge/app/fingerprint.h"
#include "moiregauge/app/frame_times.h"
#include "moiregauge/app/open_input.h"
#include "moiregauge/base/file_hash.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/measure_options.h"
#include "moiregauge/cli/common/progress.h"
#include "moiregauge/cli/measure/run_figures.h"
#include "moiregauge/cli/measure/stabilised_video.h"
#include "moiregauge/cli/measure/summary_text.h"
#include "moiregauge/drawing/overlays/overlay.h"
#include "moiregauge/drawing/overlays/overlay_inspection.h"
#include "moiregauge/io/pictures/picture_source.h"
#include "moiregauge/io/run_dir/run_directory.h"
#include "moiregauge/io/run_dir/stabilised_folder.h"
#include "moiregauge/io/run_dir/unfinished_run.h"
#include "moiregauge/report/report_page.h"
#include "moiregauge/version.h"

namespace moiregauge::internal::cli {
namespace {

std::vector<std::uint8_t> overlay_of(const ImageView<std::uint8_t>& picture, const Reference& reference) {
  return draw_overlay({picture, &reference,
                       fmt::format("reference frame {}; blue: references, must stand still; orange: targets, may move; "
                                   "inner frames: where the phase is averaged",
                                   reference.seen.frame)});
}

// Of a refused run the picture shows all that was seen instead, as `inspect` does: what is missing is in the eye then.
std::vector<std::uint8_t> overlay_of_refusal(const Measurement& m, const MeasureOptions& options) {
  const ImageView<std::uint8_t> picture = m.picture.grey.view();
  if (picture.width == 0) return {};
  InspectOptions looked_at;
  if (options.pitch_mm)
    looked_at.pitch_mm = options.pitch_mm;
  else
    looked_at.site = options.site;
  looked_at.axes = options.axes;
  looked_at.lens = options.camera.value_or(Camera{});
  looked_at.observe = options.observe;
  Inspection seen = inspect_picture({picture, 8}, looked_at);
  seen.missing = m.refusal;
  return draw_inspection({picture, seen, {}, "not measured: " + m.input.path});
}

using Overlay = std::future<std::vector<std::uint8_t>>;

// overlay.png, drawn and packed while the run is concluded: neither needs the other. Not with --threads 1; and what a
// refusal shows is known at the end only.
Overlay overlay_beside(const Measurement& seen, const MeasureOptions& options, int threads) {
  const auto draw = [&] {
    return seen.reference ? overlay_of(seen.picture.grey.view(), *seen.reference) : overlay_of_refusal(seen, options);
  };
  if (seen.reference && threads != 1) {
    try {
      return std::async(std::launch::async, draw);
    } catch (const std::system_error&) {  // no thread can start: it is drawn when it is asked for
    }
  }
  return std::async(std::launch::deferred, draw);
}

// The two folders are each put in place as a whole: neither may hold the other.
std::optional<std::string> stabilised_problem(const MeasureArgs& args, const std::string& output) {
  if (args.stabilised.empty() || !overlaps(args.stabilised, output)) return std::nullopt;
  return fmt::format("folders overlap: --stabilised {}: the results go to {}: choose a folder beside it",
                     args.stabilised, output);
}

// A method that needs circles cannot use a site without any: known before the input is read.
std::optional<std::string> reference_problem(const MeasureArgs& args, const MeasureOptions& options) {
  const auto& markers = options.site.markers;
  const bool has_any = std::any_of(markers.begin(), markers.end(), [](const Marker& marker) {
    return marker.role == Role::kReference && marker.circle.has_value();
  });
  if (args.site.empty() || has_any || !options.method->needs_circles) return std::nullopt;
  return fmt::format(
      "no references: --site {}: method {} needs 4 reference circles: add [[reference]] markers, or give --method "
      "conventional",
      args.site, options.method->name);
}

// The rows of one picture are read before those of the next.
std::optional<std::string> readout_problem(const MeasureArgs& args, const MeasureOptions& options,
                                           const InputInfo& input) {
  constexpr double kRounding = 1.01;
  if (!options.solve.readout_s || !(input.fps > 0.0) || *options.solve.readout_s * input.fps <= kRounding)
    return std::nullopt;
  return fmt::format("readout time: --readout {}: a frame lasts {:.4g} s only: give a shorter time, or the right --fps",
                     args.readout, 1.0 / input.fps);
}

RunStart start_of(const MeasureArgs& args, const InputOptions& input_options, const InputInfo& input) {
  const auto files = files_of_input(args.input, input_options);
  return {kVersion, files ? quick_fingerprint(*files) : std::string{}, args.fps, args.sequence, input};
}

Earlier earlier_of(const MeasureArgs& args) {
  return args.resume ? Earlier::kResume : args.restart ? Earlier::kRestart : Earlier::kAsk;
}

// The run is in its place, or in DIR.unfinished: says how it ended.
int ended(const Measurement& measured, const MeasureOptions& options, const ReportArgs& args) {
  const int exit = report(measured, options, args);
  if (!measured.interrupted) return exit;
  return fail(Exit::kInterrupted, fmt::format("stopped at frame {}: the results so far are in {}: go on with --resume",
                                              measured.observations.back().frame, args.output));
}

// A statement that the frames contradict gives no results, and costs no frames: `solve` and --resume use them again.
int kept_without_results(const Measurement& measured, MeasureOptions options, UnfinishedRun& journal,
                         const RunPlace& place) {
  if (measured.observations.empty()) return fail(Exit::kUsage, measured.contradiction);
  options.solve.rest.reset();
  if (const auto ended = journal.end(measured, options); !ended) return fail_output(ended.error());
  return fail(Exit::kUsage,
              fmt::format("{}: give other frames or leave it out: all {} frames are kept, `moiregauge solve "
                          "{}.unfinished -o {}` needs no video",
                          measured.contradiction, measured.observations.size(), place.shown, place.shown));
}

int run(const MeasureArgs& args) {
  const auto options = parse_measure_options(args);
  if (!options) return fail(Exit::kUsage, options.error().message);
  const auto figures = figure_formats(args.figures);
  if (!figures) return fail(Exit::kUsage, figures.error().message);
  if (const auto problem = reference_problem(args, *options)) return fail(Exit::kUsage, *problem);
  const std::string output = args.output.empty() ? default_output(args.input) : args.output;
  if (const auto problem = stabilised_problem(args, output)) return fail(Exit::kUsage, *problem);
  const InputOptions input_options{args.fps, args.sequence, args.threads, args.max_pixels};
  auto opened = open_input(args.input, input_options);
  if (!opened) return fail(Exit::kInputUnreadable, opened.error().message);
  if (const auto problem = camera_problem(options->camera.value_or(Camera{}), (*opened)->info()))
    return fail(Exit::kUsage, *problem);
  if (const auto problem = readout_problem(args, *options, (*opened)->info())) return fail(Exit::kUsage, *problem);
  Fingerprint fingerprint(args.input, input_options);
  tl::expected<Measurement, InputError> measured;
  Overlay overlay;  // of `measured`, so it must not outlive it
  const RunPlace place = place_of_run(output);
  RunDirectory directory(
      place, [&](const Measurement&) { return overlay.get(); }, report_page);
  directory.also(put_figures(*figures, args.quiet));
  // A taken folder is found before, not after, hours of measuring.
  if (const auto free = directory.check([&] { return fingerprint.hex(); }); !free)
    return fail(Exit::kUsage, free.error().message);
  std::optional<StabilisedFolder> stabilised;
  if (!args.stabilised.empty()) {
    stabilised.emplace(args.stabilised);
    if (const auto begun = stabilised->open(); !begun) return fail_output(begun.error());
  }
  UnfinishedRun journal(place);
  auto so_far = journal.begin(start_of(args, input_options, (*opened)->info()), *options, earlier_of(args));
  if (!so_far) return fail_output(so_far.error());
  FrameTimes times;
  // What was opened to look at is measured; --reference-frame asks for the input a second time.
  const auto open = [&]() -> tl::expected<std::unique_ptr<FrameSource>, InputError> {
    auto source = *opened ? std::move(opened) : open_input(args.input, input_options);
    if (!source) return source;
    return timed(std::move(*source), times);
  };
  const OpenInput again = [&] { return open_input(args.input, input_options); };
  if (args.video) directory.also(put_video({args.exaggeration, args.quiet}, again, *options));
  {
    const InterruptGuard guard;
    std::optional<Progress> progress(std::in_place, "measuring", args.quiet);
    measured = observe_all(open, *options,
                           [&](long done, long expected) {
                             progress->show(done, expected, times.waiting_share());
                             return !interrupted();
                           },
                           {stabilised ? &*stabilised : nullptr, &journal, *std::move(so_far)});
    if (const auto closed = journal.close(); !closed) return fail_output(closed.error());
    progress.reset();
    if (measured) {
      const ElapsedLine line(fmt::format("solving {} frames", measured->observations.size()), args.quiet);
      overlay = overlay_beside(*measured, *options, args.threads);
      evaluate(*options, *measured);
    }
  }
  if (!measured) return fail(Exit::kInputUnreadable, measured.error().message);
  measured->input.sha256 = fingerprint.hex();
  if (!measured->contradiction.empty()) return kept_without_results(*measured, *options, journal, place);
  // Of a run that is stopped they are made when it goes on: then they are all there.
  const tl::expected<void, OutputError> pictures =
      stabilised && !measured->interrupted ? stabilised->finish() : tl::expected<void, OutputError>{};
  if (!pictures) measured->exit = Exit::kOutputUnwritable;  // the results are kept all the same
  const auto written = journal.end(*measured, *options).and_then([&] { return directory.write(*measured, *options); });
  if (!written) return fail_output(written.error());
  const int exit = ended(*measured, *options, {args.input, directory.results(), args.quiet, args.json});
  return pictures ? exit : fail_output(pictures.error());
}

}  // namespace

void add_measure(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("measure", "Read displacement in millimetres from a video or a folder of pictures");
  auto args = std::make_shared<MeasureArgs>();
  command
      ->add_option("INPUT", args->input, "video, folder of pictures, multi-page TIFF, or printf pattern (--sequence)")
      ->type_name("FILE")
      ->required();
  command->add_option("--site", args->site, "site.toml: what is printed where")->type_name("FILE");
  command->add_option("--pitch", args->pitch, "grating pitch with its unit, e.g. 10mm (without a site file)")
      ->type_name("LENGTH");
  command
      ->add_option("--axes", args->axes,
                   "without a site file, x lies along: print (the references' gratings) or image [print]")
      ->type_name("print|image");
  std::string methods;
  for (const Method& method : kMethods) methods += fmt::format("\n  {}: {}", method.name, method.summary);
  command->add_option("--method", args->method, "how to measure [" + std::string(kDefaultMethod) + "]" + methods)
      ->type_name("conventional|two-stage|precise");
  command->add_option("--camera", args->camera, "calibrated camera: our TOML or OpenCV/ROS YAML")->type_name("FILE");
  command->add_option("--fps", args->fps, "frames per second of a folder of pictures")->type_name("N");
  command
      ->add_option("--reference-frame", args->reference_frame,
                   "frame of zero displacement [first that can be measured]")
      ->type_name("N");
  command->add_option("--frames", args->frames, "only these frames, half open: A:B or A:B:STEP")->type_name("A:B:STEP");
  command
      ->add_option(
          "--tone", args->tone,
          "tone curve of the grey levels: auto (as the input says, or its prints show), linear, srgb, bt709, hlg, "
          "pq or gamma:2.2 [auto]")
      ->type_name("auto|linear|srgb|bt709|gamma:G");
  command
      ->add_option(
          "--template", args->template_use,
          "precise: use the print's harmonics, on, off (fundamentals alone; u is wide on binary prints) or auto "
          "[auto]")
      ->type_name("on|off|auto");
  command->add_option("--rest", args->rest, "frames in which no target moves, half open: A:B")->type_name("A:B");
  command
      ->add_option(
          "--readout", args->readout,
          "rolling shutter: first row's exposure to the last one's, e.g. 18ms; 0ms: none [told by the footage]")
      ->type_name("TIME");
  add_print_scale(*command, args->print_scale);
  command->add_option("-o,--out", args->output, "output folder [<input>-moiregauge]")->type_name("DIR");
  command
      ->add_option("--stabilised", args->stabilised,
                   "also write every marker as a still camera would see it, frame by frame")
      ->type_name("DIR");
  add_figures(*command, args->figures);
  command->add_flag("--video", args->video,
                    "also draw stabilised.mp4: as filmed, and beside it the camera's motion taken out");
  command
      ->add_option("--exaggerate", args->exaggeration,
                   "with --video: targets move so many times as far [what shows the motion best]")
      ->type_name("N");
  command->add_option("--threads", args->threads, "threads to use; never changes a result")
      ->check(CLI::Range(0, 1024).description(""))
      ->type_name("N");
  add_max_pixels(*command, args->max_pixels);
  command->add_flag("--sequence", args->sequence, "INPUT is a printf pattern such as shot%04d.png");
  command->add_flag("--resume", args->resume, "go on with an unfinished run, if there is one");
  command->add_flag("--restart", args->restart, "throw an unfinished run away, if there is one");
  command->add_flag("--quiet", args->quiet, "print nothing but errors");
  command->add_flag("--json", args->json, "print run.json on stdout");
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
