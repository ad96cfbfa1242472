// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/live/command_live.h"

#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/json_progress.h"
#include "moiregauge/cli/common/shared_options.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/live/live_args.h"
#include "moiregauge/cli/live/live_display.h"
#include "moiregauge/cli/live/live_preview.h"
#include "moiregauge/cli/live/live_samples.h"
#include "moiregauge/cli/measure/command_measure.h"
#include "moiregauge/cli/measure/summary_text.h"
#include "moiregauge/live/health_text.h"

namespace moiregauge::internal::cli {
namespace {

std::string lost_note(const FinishedLive& done) {
  if (done.health.lost.frames() == 0) return {};
  return fmt::format("warning: {} of {} frames were not measured: {}. Remedy: a lower frame rate, or a smaller image\n",
                     done.health.lost.frames(), done.health.lost.frames() + done.health.frames,
                     lost_text(done.health.lost));
}

// Lines of a run whose segments were solved one by one.
std::string segments_text(const FinishedLive& done, const std::string& folder) {
  std::string targets;
  for (const std::size_t target : done.run.targets)
    targets += fmt::format("{}{}", targets.empty() ? "" : ", ", done.run.markers[target]);
  return fmt::format(
      "found: {} ({}) in {} frames; reference frame {}\nresult: {} of {} rows are ok in {} segment{}\n"
      "next: open {}/report.html in a browser; each segment of {} is a run directory\n",
      done.run.targets.size() == 1 ? "1 target" : fmt::format("{} targets", done.run.targets.size()), targets,
      done.health.frames, done.run.reference_frame, done.stored.ok_rows, done.stored.rows, done.stored.segments.size(),
      done.stored.segments.size() == 1 ? "" : "s", done.stored.segments.empty() ? folder : done.stored.segments.back(),
      folder);
}

int report_segments(const FinishedLive& done, const LiveRequest& request, const MeasureArgs& args) {
  if (!args.quiet && !args.json) print_out(segments_text(done, request.store.folder));
  if (done.exit == Exit::kRefused)
    return fail(Exit::kRefused, fmt::format("the run is refused because no row is ok: {}: see the report of its last "
                                            "segment in {}",
                                            done.run.source, request.store.folder));
  return static_cast<int>(done.exit);
}

int report_live(const FinishedLive& done, const LiveRequest& request, const MeasureArgs& args) {
  if (!args.quiet) print_note(lost_note(done));
  // JSON lines end with one that states the exit code.
  const bool has_text = !args.json;
  int exit = 0;
  if (done.stored.run)
    exit = report(done.stored.run->measurement, request.options,
                  {done.stored.run->measurement.input.path, done.stored.run->folder, args.quiet || !has_text, false});
  else
    exit = report_segments(done, request, args);
  if (done.end.why == LiveStop::kLost) exit = fail(Exit::kSourceLost, done.end.message);
  if (args.json)
    print_out(nlohmann::ordered_json{{"type", "end"}, {"exit_code", exit}, {"folder", request.store.folder}}.dump() +
              "\n");
  return exit;
}

// Warnings of the outlets, once they are finished.
std::string outlet_notes(const Publishers& outlets) {
  std::string notes;
  for (const auto& outlet : outlets.all) {
    if (outlet->lost_rows() == 0) continue;
    const auto [name, state] = outlet->state();
    notes += fmt::format("warning: {} rows did not reach {} ({}). The run directory has them\n", outlet->lost_rows(),
                         name, state);
  }
  if (!outlets.recorder) return notes;
  if (const std::string problem = outlets.recorder->problem(); !problem.empty())
    notes += fmt::format("warning: a recording of an alarm is incomplete: {}. Free space\n", problem);
  if (outlets.recorder->lost_frames() > 0)
    notes += fmt::format("warning: {} frames are missing in recordings of alarms, because the disk was too slow\n",
                         outlets.recorder->lost_frames());
  return notes;
}

int run(const LiveArgs& args) {
  if (args.is_list) {
    print_out(camera_list_text());
    return static_cast<int>(Exit::kMeasured);
  }
  if (args.measure.input.empty())
    return fail(Exit::kUsage, "the source is missing: live: give SOURCE, or see the cameras with --list");
  auto request = live_request(args);
  if (!request) return fail(Exit::kUsage, request.error().message);
  const MeasureArgs& words = args.measure;
  LiveDisplay display(words.json ? LiveOutput::kJsonLines : words.quiet ? LiveOutput::kNothing : LiveOutput::kLine);
  request->publishers.push_back(&display);
  auto outlets = open_outlets(args.outlets, request->store.folder, display);
  if (!outlets) return fail(Exit::kUsage, outlets.error().message);
  for (const auto& outlet : outlets->all) request->publishers.push_back(outlet.get());
  request->recorder = outlets->recorder.get();
  std::optional<LiveSamples> samples;
  if (!args.progress.empty()) request->publishers.push_back(&samples.emplace());
  std::optional<LivePreview> preview;
  if (!args.preview.empty()) request->recorder = &preview.emplace(args.preview, request->recorder);
  const InterruptGuard guard;
  const auto done = run_live(*request, {[] { return interrupted(); }, {}});
  display.finish(0.0);
  if (samples) samples->finish(0.0);
  if (outlets->recorder) outlets->recorder->finish();
  if (!words.quiet) print_note(outlet_notes(*outlets));
  if (!done) return fail(done.error().exit, done.error().message);
  return report_live(*done, *request, words);
}

void add_source(CLI::App& command, LiveArgs& args) {
  command
      .add_option("SOURCE", args.measure.input,
                  "camera, camera:ID, rtsp://..., - (y4m), or a recording that is replayed as by a camera (--pace)")
      ->type_name("TEXT");
  command.add_flag("--list", args.is_list, "lists the cameras of this computer and its networks");
  command.add_option("--pace", args.pace, "replays at N times the recording's speed; max: as fast as it is measured")
      ->type_name("N|max");
  command.add_option("--for", args.max_time, "ends after this time, e.g. 10min [never]")->type_name("TIME");
  command.add_option("--fps", args.measure.fps, "frames per second of a folder of images")->type_name("N");
  add_slow_motion(command, args.measure.slow_motion);
  command.add_flag("--sequence", args.measure.sequence, "SOURCE is a printf pattern such as shot%04d.png");
}

void add_store(CLI::App& command, LiveArgs& args) {
  command.add_option("-o,--out", args.measure.output, "output folder [<source>-live]")->type_name("DIR");
  command.add_option("--segment", args.segment, "begins a new run directory in DIR every TIME, e.g. 1h [one run]")
      ->type_name("TIME");
  command.add_option("--keep", args.keep, "deletes segments that are older, e.g. 30d [never]")->type_name("TIME");
  command.add_option("--quota", args.quota, "deletes the oldest segments beyond this size of DIR, e.g. 100GB [none]")
      ->type_name("SIZE");
  command.add_flag("--resume", args.measure.resume, "continues the run in DIR with the same zero, if there is one");
  command.add_flag("--restart", args.measure.restart, "delete an unfinished run, if there is one");
  command.add_option("--preview", args.preview, "writes the newest frame as a JPEG, five times a second [nothing]")
      ->type_name("FILE");
  add_progress(command, args.progress);
  command.add_flag("--quiet", args.measure.quiet, "print nothing but errors");
  command.add_flag("--json", args.measure.json, "print a JSON line on stdout once a second");
}

}  // namespace

void add_live(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("live", "Measure while a camera delivers frames, and publish every row");
  auto args = std::make_shared<LiveArgs>();
  add_source(*command, *args);
  for (const auto add : {add_print_options, add_camera_options, add_method_options}) add(*command, args->measure);
  add_source_options(*command, args->source);
  add_outlet_options(*command, args->outlets);
  add_store(*command, *args);
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
