// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/command_plan.h"

#include <memory>

#include <fmt/format.h>

#include "moiregauge/app/camera_table.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/plan/plan_lines.h"

namespace moiregauge::internal::cli {
namespace {

int run(const PlanWords& words) {
  const auto order = understood(words);
  if (!order) return fail(Exit::kUsage, order.error().message);
  print_out(words.json ? plan_json(*order) : plan_text(*order));
  return 0;
}

void add_camera_options(CLI::App& command, PlanWords& words) {
  command.add_option("--distance", words.distance, "from the camera to the prints, e.g. 5m")->type_name("LENGTH");
  command.add_option("--camera", words.camera, "a camera file, or one of " + camera_names())->type_name("NAME|FILE");
  command.add_option("--focal", words.focal, "focal length of the lens, e.g. 12mm")->type_name("LENGTH");
  command.add_option("--fov", words.fov_deg, "instead: degrees that the picture shows across its width")
      ->type_name("DEG");
  command.add_option("--resolution", words.resolution, "pixels of the picture, e.g. 4096x2160")->type_name("WxH");
  command.add_option("--pixel", words.pixel, "side of the sensor's pixels, e.g. 3.45um")->type_name("LENGTH");
  command.add_option("--noise", words.noise, "of a pixel, grey levels of 8 bits [1.5]")->type_name("SIGMA");
  command.add_option("--contrast", words.contrast, "grey levels from ink to paper [170]")->type_name("N");
  command.add_option("--psf", words.psf_px, "sharpness: sigma of the lens' point spread, px [0.7]")->type_name("PX");
  command.add_option("--fps", words.fps, "frames per second [30]")->type_name("N");
  command.add_option("--exposure", words.exposure, "of a frame, e.g. 5ms [a quarter of a frame]")->type_name("TIME");
  command
      .add_option("--readout", words.readout,
                  "rolling shutter: first row's exposure to the last one's, e.g. 18ms [none]")
      ->type_name("TIME");
  command.add_flag("--lossless", words.lossless, "the recording is raw or lossless, also by a telephone");
  command.add_flag("--compressed", words.compressed,
                   "the recording is compressed video (H.264, H.265), as telephones make");
  command.add_option("--vibration", words.vibration, "of the targets: amplitude and frequency, e.g. 0.5mm@5Hz")
      ->type_name("A@F");
  command.add_option("--camera-vibration", words.camera_vibration, "of the camera's direction, e.g. 0.01deg@10Hz")
      ->type_name("A@F");
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("plan", "What a set-up will reach, before anything is printed or filmed");
  auto words = std::make_shared<PlanWords>();
  add_camera_options(*command, *words);
  add_layout_options(*command, words->layout);
  command->add_flag("--json", words->json, "as JSON");
  command->callback([words, &exit_code] { exit_code = run(*words); });
}

}  // namespace moiregauge::internal::cli
