// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_inspect.h"

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "moiregauge/app/inspect_frame.h"
#include "moiregauge/app/inspection/inspect_input.h"
#include "moiregauge/base/atomic_file.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/output_folder.h"
#include "moiregauge/cli/common/progress.h"
#include "moiregauge/cli/common/shared_options.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/measure/inspect_text.h"
#include "moiregauge/io/config/site_draft.h"

namespace moiregauge::internal::cli {
namespace {

namespace fs = std::filesystem;

struct InspectWords : InspectArgs {
  std::string site_file;  // --write-site
};

tl::expected<void, std::string> write_inspection(const fs::path& output, const InspectedFrame& inspected) {
  std::error_code error;
  fs::create_directories(output, error);
  if (error) return tl::unexpected(fmt::format("{}: {}", output.string(), error.message()));
  const auto overlay = overlay_of_inspection(inspected);
  const std::string path = (output / "overlay.png").string();
  if (overlay.empty()) return tl::unexpected(path + ": out of memory");
  return write_file_atomically(path, {reinterpret_cast<const char*>(overlay.data()), overlay.size()}).and_then([&] {
    return write_file_atomically((output / "inspect.json").string(), inspect_json_text(inspected.report));
  });
}

// Writes the site file of --write-site.
tl::expected<void, RunFailure> write_site_draft(const InspectWords& args, const InspectReport& report) {
  const std::string& path = args.site_file;
  const std::string text = site_draft(report.seen, fmt::format("{}, frame {}", report.input.path, report.frame));
  if (path == "-") {
    print_out(text);
    return {};
  }
  if (const auto written = write_file_atomically(path, text); !written)
    return tl::unexpected(RunFailure{
        Exit::kOutputUnwritable,
        fmt::format("the site file could not be written: {}: choose another with --write-site", written.error())});
  return {};
}

// A site file needs a scale, and it never replaces another file: that may be a survey.
std::optional<std::string> site_file_problem(const InspectWords& args, bool is_scaled) {
  const std::string& path = args.site_file;
  if (path.empty()) return std::nullopt;
  if (!is_scaled)
    return fmt::format("a site file needs the scale: --write-site {}: add --pitch, e.g. --pitch 10mm", path);
  std::error_code error;
  if (path == "-" || !fs::exists(fs::symlink_status(path, error))) return std::nullopt;
  return fmt::format("the file exists: --write-site {}: choose another name, or remove it", path);
}

int report_refusal(const InspectReport& report, const std::string& output) {
  return fail(Exit::kRefused, fmt::format("{}: {}, frame {} ({}): see {}/overlay.png", report.seen.missing,
                                          report.input.path, report.frame, found_in_short(report.seen), output));
}

int run(const InspectWords& args) {
  const auto options = inspect_options(args);
  if (!options) return fail(Exit::kUsage, options.error().message);
  if (const auto problem = site_file_problem(args, has_scale(*options))) return fail(Exit::kUsage, *problem);
  const std::string& input = args.measure.input;
  const std::string output = args.measure.output.empty() ? default_output(input, "-inspect") : args.measure.output;
  if (!is_free(output, "inspect.json"))
    return fail(Exit::kUsage, fmt::format("the output folder holds other files: {}: choose another with -o", output));
  const auto inspected = [&] {
    Progress progress("reading", args.measure.quiet);
    return inspect_input(args, *options, [&](long done, long expected) { progress.show(done, expected); });
  }();
  if (!inspected) return fail(inspected.error().exit, inspected.error().message);
  const InspectReport& report = inspected->report;
  if (const auto written = write_inspection(output, *inspected); !written)
    return fail(Exit::kOutputUnwritable,
                fmt::format("the results could not be written: {}: free space or choose another folder with -o",
                            written.error()));
  if (!args.site_file.empty() && report.seen.reference) {
    if (const auto written = write_site_draft(args, report); !written)
      return fail(written.error().exit, written.error().message);
  }
  if (args.site_file == "-") return report.exit == Exit::kRefused ? report_refusal(report, output) : 0;
  if (args.measure.json)
    print_out(inspect_json_text(report));
  else if (!args.measure.quiet)
    print_out(inspect_text(report));
  return report.exit == Exit::kRefused ? report_refusal(report, output) : 0;
}

}  // namespace

void add_inspect(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("inspect", "Show the markers found in one frame");
  auto args = std::make_shared<InspectWords>();
  MeasureArgs& shared = args->measure;
  command->add_option("INPUT", shared.input, "video, image, folder of images, multi-page TIFF, or printf pattern")
      ->type_name("FILE")
      ->required();
  command->add_option("--frame", args->frame, "frame to inspect, the first is 0 [0]")->type_name("N");
  command->add_option("--site", shared.site, "site.toml, the markers and their positions")->type_name("FILE");
  command->add_option("--pitch", shared.pitch, "grating pitch with its unit, e.g. 10mm (without a site file)")
      ->type_name("LENGTH");
  command->add_option("--axes", shared.axes, "without a site file, direction of x: print or image [print]")
      ->type_name("print|image");
  command->add_option("--camera", shared.camera, "calibrated camera, our TOML or OpenCV/ROS YAML")->type_name("FILE");
  command->add_option("--fps", shared.fps, "frames per second of a folder of images")->type_name("N");
  command->add_option("-o,--out", shared.output, "output folder [<input>-inspect]")->type_name("DIR");
  command->add_option("--write-site", args->site_file, "write the markers found as a site file; - for stdout")
      ->type_name("FILE");
  add_marker_choice(*command, shared.choice);
  add_max_pixels(*command, shared.max_pixels);
  command->add_flag("--sequence", shared.sequence, "INPUT is a printf pattern such as shot%04d.png");
  command->add_flag("--quiet", shared.quiet, "print nothing but errors");
  command->add_flag("--json", shared.json, "print inspect.json on stdout instead of text");
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
