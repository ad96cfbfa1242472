// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_solve.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/measure_options.h"
#include "moiregauge/cli/common/progress.h"
#include "moiregauge/cli/measure/run_figures.h"
#include "moiregauge/cli/measure/summary_text.h"
#include "moiregauge/io/journal/run_file.h"
#include "moiregauge/io/run_dir/run_directory.h"
#include "moiregauge/observation/views/reprojection.h"
#include "moiregauge/report/report_page.h"

namespace moiregauge::internal::cli {
namespace {

struct SolveArgs {
  std::string run;
  std::string site;
  std::string camera;
  std::string method;
  std::string rest;
  std::string readout;
  PrintScaleArgs print_scale;
  std::string output;
  std::string figures;
  bool quiet = false;
  bool json = false;
};

using Done = tl::expected<void, UsageError>;

// `precise` looks at everything that `two-stage` does, and at more; `conventional` looks elsewhere.
bool has_seen_enough_for(const Method& measured, const Method& wanted) {
  return measured.name == wanted.name || (measured.name == "precise" && wanted.name == "two-stage");
}

Done choose_method(const SolveArgs& args, MeasureOptions& options) {
  if (args.method.empty()) return {};
  const auto wanted = method_of(args.method);
  if (!wanted) return tl::unexpected(wanted.error());
  if (!has_seen_enough_for(*options.method, **wanted))
    return usage(
        fmt::format("other method: --method {}: this run was measured by `{}`, which did not look at what `{}` "
                    "needs: measure the input again with --method {}",
                    args.method, options.method->name, args.method, args.method));
  options.method = *wanted;
  return {};
}

// What the rulers showed counts from the nominal prints: of the run's own site they are no longer nominal.
Done rescale(const PrintScaleArgs& args, bool has_new_site, MeasureOptions& options, Site& site) {
  const auto scale = print_scale_of(args);
  if (!scale) return tl::unexpected(scale.error());
  if (!*scale) {
    if (has_new_site) options.print_scale = {};
    return {};
  }
  PrintScale more = **scale;
  if (!has_new_site) more.factor /= options.print_scale.factor;
  site = with_prints_scaled(std::move(site), more);
  if (options.pitch_mm) {  // no site file: places were counted in pitches
    site = with_places_scaled(std::move(site), more.factor);
    *options.pitch_mm *= more.factor;
  }
  options.print_scale = **scale;
  return {};
}

// Another site, print scale or lens: the observations are carried over to it.
Done restate(const SolveArgs& args, StoredRun& run) {
  if (!args.site.empty()) {
    auto site = site_of_file(args.site);
    if (!site) return tl::unexpected(site.error());
    run.options.site = *std::move(site);
    run.options.pitch_mm.reset();
  }
  if (!args.camera.empty()) {
    if (const auto taken = take_camera(args.camera, run.options); !taken) return taken;
    if (const auto problem = camera_problem(*run.options.camera, run.seen.input)) return usage(*problem);
  }
  const bool is_other_site = !args.site.empty() || !args.print_scale.factor.empty();
  Site site = args.site.empty() && run.seen.reference ? run.seen.reference->site : run.options.site;
  if (const auto scaled = rescale(args.print_scale, !args.site.empty(), run.options, site); !scaled) return scaled;
  if (is_other_site) run.options.site = site;
  if (!run.seen.reference || (!is_other_site && args.camera.empty())) return {};
  Reference& reference = *run.seen.reference;
  auto again = reproject_observations(reference, run.seen.observations, site, run.options.camera.value_or(Camera{}));
  if (!again)
    return usage(fmt::format("{}: {}: {}: measure the input again with it",
                             args.site.empty() ? "camera file" : "site file",
                             args.site.empty() ? args.camera : args.site, again.error()));
  reference = std::move(again->reference);
  run.seen.observations = std::move(again->observations);
  if (is_other_site) run.options.site = reference.site;
  return {};
}

Done choose_rest(const SolveArgs& args, MeasureOptions& options) {
  if (args.rest.empty()) return {};
  if (args.rest == "none") {
    options.solve.rest.reset();
    return {};
  }
  const auto rest = rest_frames(args.rest);
  if (!rest) return tl::unexpected(rest.error());
  options.solve.rest = *rest;
  return {};
}

// A run that was killed has no end and no results yet: what was kept of it will do. Where there are results a file that
// breaks off is damaged.
tl::expected<StoredRun, std::string> run_in(const std::string& folder) {
  namespace fs = std::filesystem;
  const std::string path = (fs::path(folder) / kRunFileName).string();
  std::error_code error;
  if (const std::string kind = kind_unless_plain(path); fs::exists(path, error) && !kind.empty())
    return tl::unexpected(fmt::format("no observations: {}: it is {}: give a folder that `measure` wrote", path, kind));
  if (!fs::exists(path, error) || fs::exists(fs::path(folder) / "run.json", error)) return read_run(path);
  auto kept = recover_run(path);
  if (!kept) return tl::unexpected(kept.error());
  if (kept->run.options.method == nullptr)
    return tl::unexpected(
        fmt::format("no observations: {}: the run was stopped before its first frame: measure again", path));
  if (!kept->has_end)
    kept->run.seen.notes.push_back(
        fmt::format("the run was not finished: these are its first {} frames", kept->run.seen.observations.size()));
  return std::move(kept->run);
}

Done choose_readout(const SolveArgs& args, MeasureOptions& options) {
  if (args.readout.empty()) return {};
  const auto readout = readout_time(args.readout);
  if (!readout) return tl::unexpected(readout.error());
  options.solve.readout_s = *readout;
  return {};
}

int run(const SolveArgs& args) {
  const auto figures = figure_formats(args.figures);
  if (!figures) return fail(Exit::kUsage, figures.error().message);
  auto stored = run_in(args.run);
  if (!stored) return fail(Exit::kInputUnreadable, stored.error());
  complete_markers(stored->seen);
  for (const Done& done : {choose_method(args, stored->options), choose_rest(args, stored->options),
                           choose_readout(args, stored->options), restate(args, *stored)}) {
    if (!done) return fail(Exit::kUsage, done.error().message);
  }
  const std::string output = args.output.empty() ? args.run : args.output;
  RunDirectory directory = RunDirectory::solved_from(place_of_run(output), args.run, report_page);
  directory.also(put_figures(*figures, args.quiet));
  if (const auto free = directory.check([&] { return stored->seen.input.sha256; }); !free)
    return fail_output(free.error());
  Measurement solved;
  static_cast<ObservationLog&>(solved) = std::move(stored->seen);
  {
    const ElapsedLine line(fmt::format("solving {} frames", solved.observations.size()), args.quiet);
    evaluate(stored->options, solved);
  }
  if (!solved.contradiction.empty())
    return fail(Exit::kUsage, solved.contradiction + ": give other frames, or --rest none: nothing was written");
  if (const auto written = directory.write(solved, stored->options); !written) return fail_output(written.error());
  return report(solved, stored->options, {args.run, output, args.quiet, args.json});
}

}  // namespace

void add_solve(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("solve", "New numbers from a finished run, without its video");
  auto args = std::make_shared<SolveArgs>();
  command->add_option("DIR", args->run, "folder that `measure` wrote")->type_name("DIR")->required();
  command->add_option("--site", args->site, "site.toml with better places, turns, heights or known_to")
      ->type_name("FILE");
  command->add_option("--camera", args->camera, "calibrated camera: our TOML or OpenCV/ROS YAML")->type_name("FILE");
  command
      ->add_option("--rest", args->rest,
                   "frames in which no target moves, half open: A:B; none: take back the run's own")
      ->type_name("A:B|none");
  command->add_option("--readout", args->readout, "rolling shutter: first row's exposure to the last one's, e.g. 18ms")
      ->type_name("TIME");
  add_print_scale(*command, args->print_scale);
  command->add_option("--method", args->method, "two-stage, of a run measured by precise [the run's own]")
      ->type_name("two-stage|precise|conventional");
  command->add_option("-o,--out", args->output, "output folder [DIR: its results are replaced]")->type_name("DIR");
  add_figures(*command, args->figures);
  command->add_flag("--quiet", args->quiet, "print nothing but errors");
  command->add_flag("--json", args->json, "print run.json on stdout");
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
