// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/command_plan.h"

#include <memory>

#include <fmt/format.h>

#include "moiregauge/app/calibrate/camera_table.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/plan/plan_text.h"

namespace moiregauge::internal::cli {
namespace {

int run(const PlanArgs& args) {
  const auto order = parse_plan_options(args);
  if (!order) return fail(Exit::kUsage, order.error().message);
  print_out(args.json ? plan_json(*order) : plan_text(*order));
  return 0;
}

void add_camera_options(CLI::App& command, PlanArgs& args) {
  command.add_option("--distance", args.distance, "from the camera to the markers, e.g. 5m")->type_name("LENGTH");
  command.add_option("--camera", args.camera, "a camera file, or one of " + camera_names())->type_name("NAME|FILE");
  command.add_option("--focal", args.focal, "focal length of the lens, e.g. 12mm")->type_name("LENGTH");
  command.add_option("--fov", args.fov_deg, "instead: horizontal field of view in degrees")->type_name("DEG");
  command.add_option("--resolution", args.resolution, "image size in pixels, e.g. 4096x2160")->type_name("WxH");
  command.add_option("--pixel", args.pixel, "side of the sensor's pixels, e.g. 3.45um")->type_name("LENGTH");
  command.add_option("--noise", args.noise, "noise of a pixel, grey levels of 8 bits [1.5]")->type_name("SIGMA");
  command.add_option("--contrast", args.contrast, "grey levels from ink to paper [170]")->type_name("N");
  command.add_option("--psf", args.psf_px, "sharpness: sigma of the lens's point spread, px [0.7]")->type_name("PX");
  command.add_option("--fps", args.fps, "frames per second [30]")->type_name("N");
  command.add_option("--exposure", args.exposure, "exposure time of a frame, e.g. 5ms [a quarter of a frame]")
      ->type_name("TIME");
  command
      .add_option("--readout", args.readout,
                  "rolling shutter: readout time, from the first row to the last, e.g. 18ms [none]")
      ->type_name("TIME");
  command.add_flag("--lossless", args.lossless, "the recording is raw or lossless, even on a phone");
  command.add_flag("--compressed", args.compressed, "the recording is compressed video (H.264, H.265), as on phones");
  command
      .add_option("--vibration", args.vibration, "vibration of the targets: amplitude and frequency, e.g. 0.5mm@5Hz")
      ->type_name("A@F");
  command
      .add_option("--camera-vibration", args.camera_vibration, "vibration of the camera's direction, e.g. 0.01deg@10Hz")
      ->type_name("A@F");
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("plan", "Predict the uncertainty of a set-up before you print or film");
  auto args = std::make_shared<PlanArgs>();
  add_camera_options(*command, *args);
  add_layout_options(*command, args->layout);
  command->add_flag("--json", args->json, "print everything as JSON");
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
