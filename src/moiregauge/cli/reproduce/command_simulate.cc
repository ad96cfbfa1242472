// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/command_simulate.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "moiregauge/app/load_scenario.h"
#include "moiregauge/app/simulation/write_recording.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/output_folder.h"
#include "moiregauge/cli/common/progress.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::cli {
namespace {

namespace fs = std::filesystem;
using simulator::Scenario;
template <typename Value>
using Expected = tl::expected<Value, std::string>;

struct SimulateArgs {
  std::string scenario;
  std::string output;
  std::vector<std::string> settings;
  std::optional<std::uint64_t> seed;
  std::optional<long> frames;
  std::string codec;
  std::optional<int> quality;
  std::optional<int> gop;
  int threads = 0;
  bool markers_only = false;
  bool list = false;
  bool quiet = false;
};

std::string list_of_scenarios() {
  std::string text;
  for (const auto& entry : simulator::built_in_scenarios())
    text += fmt::format("{:<15} {}\n", entry.name, entry.summary);
  return text;
}

// Returns the video format of --codec, --quality and --gop.
Expected<std::optional<VideoFormat>> video_of(const SimulateArgs& args, const Scenario& scenario) {
  if (args.codec.empty()) {
    if (args.quality || args.gop)
      return tl::unexpected(std::string("--quality and --gop apply to videos: simulate: add --codec"));
    return std::nullopt;
  }
  const auto codec = codec_named(args.codec);
  if (!codec)
    return tl::unexpected(fmt::format("the codec is unknown: --codec {}: choose one of ffv1, x264, mjpeg", args.codec));
  if (args.gop && *codec != VideoCodec::kX264)
    return tl::unexpected(std::string("--gop applies to x264: simulate: remove it"));
  VideoFormat format{*codec, args.quality};
  format.is_linear = simulator::stores_light(scenario);
  format.gop = args.gop.value_or(format.gop);
  format.width = scenario.camera.width;
  format.height = scenario.camera.height;
  format.bits = scenario.sensor.bits;
  format.fps = scenario.sensor.fps;
  if (const auto problem = problem_with(format)) return tl::unexpected(*problem);
  return format;
}

// Returns the folder's name. A built-in name such as "rig-0.1x" has no file extension.
fs::path default_folder(const std::string& scenario) {
  const bool is_built_in = simulator::built_in(scenario).has_value();
  return (is_built_in ? scenario : fs::path(scenario).stem().string()) + "-simulated";
}

int run(const SimulateArgs& args) {
  if (args.list) {
    print_out(list_of_scenarios());
    return 0;
  }
  if (args.scenario.empty())
    return fail(Exit::kUsage, "the scenario is missing: simulate: give a file or a name of moiregauge simulate --list");
  const auto scenario = load_scenario({args.scenario, args.settings, args.seed, args.frames});
  if (!scenario) return fail(Exit::kUsage, scenario.error());
  const auto video = video_of(args, *scenario);
  if (!video) return fail(Exit::kUsage, video.error());
  const fs::path output = args.output.empty() ? default_folder(args.scenario) : fs::path(args.output);
  if (!is_free(output, "truth-camera.toml")) {
    return fail(Exit::kUsage,
                fmt::format("the output folder holds other files: {}: choose another with -o", output.string()));
  }
  const InterruptGuard guard;
  const auto written = [&] {
    Progress progress("simulating", args.quiet);
    const auto show = [&](long done, long expected) {
      progress.show(done, expected);
      return !interrupted();
    };
    const auto area = args.markers_only ? simulator::Area::kMarkersOnly : simulator::Area::kWholeFrame;
    return write_recording(*scenario, {*video, area, args.threads, show}, output.string());
  }();
  if (!written) {
    if (interrupted())
      return fail(Exit::kInterrupted, fmt::format("{}: {} is incomplete: repeat the command to start again",
                                                  written.error(), output.string()));
    return fail(Exit::kOutputUnwritable,
                fmt::format("the recording could not be written: {}: free space or choose another folder with -o",
                            written.error()));
  }
  if (!args.quiet) print_out(fmt::format("{} frames of {} in {}\n", scenario->frames, scenario->name, output.string()));
  return 0;
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<SimulateArgs>();
  CLI::App* command = app.add_subcommand("simulate", "Make a recording with known truth");
  command->add_option("SCENARIO", args->scenario, "built-in name (see --list) or TOML file")->type_name("FILE");
  command->add_option("-o,--out", args->output, "folder to write [SCENARIO-simulated]")->type_name("DIR");
  command->add_option("--set", args->settings, "override one value, e.g. lens.k1=-0.0225 (repeatable)")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1);
  command->add_option("--seed", args->seed, "seed of the random noise [1]")->type_name("N");
  command->add_option("--frames", args->frames, "number of frames [the scenario's]")->type_name("N");
  command->add_option("--codec", args->codec, "write a video instead of images: ffv1 (lossless), x264 or mjpeg")
      ->type_name("ffv1|x264|mjpeg");
  command->add_option("--quality", args->quality, "x264: rate factor, 0 to 51 [23]; mjpeg: quantiser, 2 to 31 [3]")
      ->type_name("N");
  command->add_option("--gop", args->gop, "x264: maximum key frame interval [250]; 1: key frames only")->type_name("N");
  command->add_option("--threads", args->threads, "number of threads, never changes a byte [all]")
      ->check(CLI::Range(0, 1024).description(""))
      ->type_name("N")
      ->check(CLI::Validator(CLI::NonNegativeNumber).description(""));
  command->add_flag("--markers-only", args->markers_only, "draw only the markers, on flat grey");
  command->add_flag("--list", args->list, "list the built-in scenarios");
  command->add_flag("--quiet", args->quiet, "print nothing but errors");
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
