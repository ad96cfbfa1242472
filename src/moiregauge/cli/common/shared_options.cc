// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/shared_options.h"

namespace moiregauge::internal::cli {

void add_print_scale(CLI::App& command, PrintScaleArgs& args) {
  command
      .add_option("--print-scale", args.factor,
                  "measured / nominal length of the sheet's rulers, e.g. 1.0012; along x and y: 1.0012,0.9990")
      ->type_name("FACTOR");
  command.add_option("--u-print-scale", args.u, "its relative standard uncertainty, e.g. 0.0002 [the site file's]")
      ->type_name("U");
}

void add_slow_motion(CLI::App& command, std::optional<double>& factor) {
  command
      .add_option("--slow-motion", factor,
                  "recorded by stored frame rate, e.g. 8 for 240 frames/s stored as 30; divides all times")
      ->type_name("FACTOR");
}

void add_marker_choice(CLI::App& command, MarkerChoiceArgs& args) {
  command.add_option("--references", args.references, "exactly these markers are references, fixed: A,B,...")
      ->type_name("NAMES")
      ->delimiter(',');
  command.add_option("--targets", args.targets, "exactly these markers are targets, may move: A,B,...")
      ->type_name("NAMES")
      ->delimiter(',');
  command.add_option("--ignore", args.ignored, "do not use these markers: A,B,...")->type_name("NAMES")->delimiter(',');
  const auto add_each = [&](const char* name, std::vector<std::string>& values, const char* text, const char* type) {
    command.add_option(name, values, text)->type_name(type)->allow_extra_args(false);
  };
  add_each("--name", args.names, "new name of a marker, e.g. T1=midspan; repeatable", "OLD=NEW");
  add_each("--region", args.regions, "look for markers only here in the reference frame, px; repeatable", "X,Y,W,H");
  add_each("--exclude-region", args.excluded_regions, "do not look for markers here; repeatable", "X,Y,W,H");
}

void add_figures(CLI::App& command, std::string& formats) {
  command.add_option("--figures", formats, "also draw figures for a paper into DIR/figures; several formats: pdf,svg")
      ->type_name("pdf|svg|png");
}

void add_max_pixels(CLI::App& command, std::int64_t& max_pixels) {
  command.add_option("--max-pixels", max_pixels, "refuse frames of more pixels before decoding [64000000]")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 28).description(""))
      ->type_name("N");
}

}  // namespace moiregauge::internal::cli
