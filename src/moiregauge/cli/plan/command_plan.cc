// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/command_plan.h"

#include <memory>

#include <fmt/format.h>

#include "moiregauge/app/camera_table.h"
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
  command.add_option("--distance", args.distance, "from the camera to the prints, e.g. 5m")->type_name("LENGTH");
  command.add_option("--camera", args.camera, "a camera file, or one of " + camera_names())->type_name("NAME|FILE");
  command.add_option("--focal", args.focal, "focal length of the lens, e.g. 12mm")->type_name("LENGTH");
  command.add_option("--fov", args.fov_deg, "instead: degrees that the picture shows across its width")
      ->type_name("DEG");
  command.add_option("--resolution", args.resolution, "pixels of the picture, e.g. 4096x2160")->type_name("WxH");
  command.add_option("--pixel", args.pixel, "side of the sensor's pixels, e.g. 3.45um")->type_name("LENGTH");
  command.add_option("--noise", args.noise, "of a pixel, grey levels of 8 bits [1.5]")->type_name("SIGMA");
  command.add_option("--contrast", args.contrast, "grey levels from ink to paper [170]")->type_name("N");
  command.add_option("--psf", args.psf_px, "sharpness: sigma of the lens' point spread, px [0.7]")->type_name("PX");
  command.add_option("--fps", args.fps, "frames per second [30]")->type_name("N");
  command.add_option("--exposure", args.exposure, "of a frame, e.g. 5ms [a quarter of a frame]")->type_name("TIME");
  command
      .add_option("--readout", args.readout,
                  "rolling shutter: first row's exposure to the last one's, e.g. 18ms [none]")
      ->type_name("TIME");
  command.add_flag("--lossless", args.lossless, "the recording is raw or lossless, also by a telephone");
  command.add_flag("--compressed", args.compressed,
                   "the recording is compressed video (H.264, H.265), as telephones make");
  command.add_option("--vibration", args.vibration, "of the targets: amplitude and frequency, e.g. 0.5mm@5Hz")
      ->type_name("A@F");
  command.add_option("--camera-vibration", args.camera_vibration, "of the camera's direction, e.g. 0.01deg@10Hz")
      ->type_name("A@F");
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("plan", "What a set-up will reach, before anything is printed or filmed");
  auto args = std::make_shared<PlanArgs>();
  add_camera_options(*command, *args);
  add_layout_options(*command, args->layout);
  command->add_flag("--json", args->json, "as JSON");
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
