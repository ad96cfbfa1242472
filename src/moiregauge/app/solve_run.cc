// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/solve_run.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/frame_range_text.h"
#include "moiregauge/app/result_args.h"
#include "moiregauge/app/run_figures.h"
#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/run_dir/run_directory.h"
#include "moiregauge/io/tables/displacement_csv.h"
#include "moiregauge/observation/views/reprojection.h"
#include "moiregauge/report/report_page.h"
#include "moiregauge/results/derived/site_channels.h"

namespace moiregauge::internal {
namespace {

using Done = tl::expected<void, UsageError>;

// `precise` observes everything that `two-stage` needs. `conventional` observes other points.
bool has_seen_enough_for(const Method& measured, const Method& wanted) {
  return measured.name == wanted.name || (measured.name == "precise" && wanted.name == "two-stage");
}

Done choose_method(const SolveArgs& args, MeasureOptions& options) {
  if (args.method.empty()) return {};
  const auto wanted = method_of(args.method);
  if (!wanted) return tl::unexpected(wanted.error());
  if (!has_seen_enough_for(*options.method, **wanted))
    return usage(
        fmt::format("the run does not contain what this method requires: --method {} after `{}`: measure the input "
                    "again with --method {}",
                    args.method, options.method->name, args.method));
  options.method = *wanted;
  return {};
}

// The ruler factor is relative to nominal gratings. The gratings of the run's own site are already scaled.
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
  if (options.pitch_mm) {  // no site file: positions are multiples of the pitch
    site = with_places_scaled(std::move(site), more.factor);
    *options.pitch_mm *= more.factor;
  }
  options.print_scale = **scale;
  return {};
}

// Reads the site and the camera into the options.
Done take_statements(const SolveArgs& args, MeasureOptions& options) {
  if (args.stated_site) {
    options.site = *args.stated_site;
  } else if (!args.site.empty()) {
    if (auto taken = take_site(args.site, options); !taken) return taken;
  }
  if (args.stated_camera) {
    options.camera = *args.stated_camera;
  } else if (!args.camera.empty()) {
    if (auto taken = take_camera(args.camera, options); !taken) return taken;
  }
  return {};
}

// Applies another site, print scale or lens, and reprojects the observations to it.
Done restate(const SolveArgs& args, StoredRun& run) {
  const bool has_site = args.stated_site || !args.site.empty();
  const bool has_camera = args.stated_camera || !args.camera.empty();
  if (auto taken = take_statements(args, run.options); !taken) return taken;
  if (has_site) run.options.pitch_mm.reset();
  if (has_camera) {
    if (const auto problem = camera_problem(*run.options.camera, run.seen.input)) return usage(*problem);
  }
  const bool is_other_site = has_site || !args.print_scale.factor.empty();
  Site site = !has_site && run.seen.reference ? run.seen.reference->site : run.options.site;
  if (auto scaled = rescale(args.print_scale, has_site, run.options, site); !scaled) return scaled;
  if (is_other_site) run.options.site = site;
  if (!run.seen.reference || (!is_other_site && !has_camera)) return {};
  Reference& reference = *run.seen.reference;
  auto again = reproject_observations(reference, run.seen.observations, site, run.options.camera.value_or(Camera{}));
  if (!again)
    return usage(fmt::format("{}: {}: correct the {}, or measure the input again with it", again.error(),
                             has_site ? args.site : args.camera, has_site ? "site file" : "camera file"));
  reference = std::move(again->reference);
  run.seen.observations = std::move(again->observations);
  if (is_other_site) run.options.site = reference.site;
  return {};
}

// Removes, renames and re-roles markers. Positions stay those of the run.
Done choose_among_markers(const SolveArgs& args, StoredRun& run) {
  const auto choice = marker_choice_of(args.choice);
  if (!choice) return tl::unexpected(choice.error());
  const auto area = search_area_of(args.choice);
  if (!area) return tl::unexpected(area.error());
  const bool has_area = !area->regions.empty() || !area->excluded.empty();
  if (!run.seen.reference || (choice->is_empty() && !has_area)) return {};
  const Reference& reference = *run.seen.reference;
  auto chosen = choose_markers(reference.site, *choice);
  if (!chosen) return usage(chosen.error());
  std::vector<std::size_t> from = chosen_indices(reference.site, *choice);
  for (std::size_t k = from.size(); k-- > 0;) {
    const Marker& marker = reference.site.markers[from[k]];
    if (area->holds(reference.view(marker.grating ? marker.grating->centre : marker.circle->centre))) continue;
    from.erase(from.begin() + static_cast<std::ptrdiff_t>(k));
    chosen->markers.erase(chosen->markers.begin() + static_cast<std::ptrdiff_t>(k));
  }
  if (std::ranges::none_of(chosen->markers, [](const Marker& marker) { return marker.role == Role::kTarget; }))
    return usage("no target is left: --targets, --ignore, --region: choose at least one marker that moves");
  auto selected = select_markers(reference, run.seen.observations, *chosen, from);
  if (!selected)
    return usage(fmt::format("{}: {}: choose other markers, or measure the input again", selected.error(), args.run));
  run.options.site = selected->reference.site;
  run.options.channels = renamed_channels(std::move(run.options.channels), reference.site, choice->names);
  run.options.choice = *choice;
  run.options.observe.area = *area;
  run.seen.reference = std::move(selected->reference);
  run.seen.observations = std::move(selected->observations);
  return {};
}

Done choose_rest(const SolveArgs& args, MeasureOptions& options) {
  if (args.rest.empty()) return {};
  if (args.rest == "none") {
    options.solve.rest.reset();
    return {};
  }
  const auto rest = frame_range_in(args.rest, kRestOption);
  if (!rest) return tl::unexpected(rest.error());
  options.solve.rest = *rest;
  return {};
}

Done choose_zero(const SolveArgs& args, MeasureOptions& options) {
  if (args.zero.empty()) return {};
  if (args.zero == "none") {
    options.zero.reset();
    return {};
  }
  const auto zero = frame_range_in(args.zero, kZeroOption);
  if (!zero) return tl::unexpected(zero.error());
  options.zero = *zero;
  return {};
}

// Gives every frame another time. Without --fps the stored times are kept, and only the factor is replaced.
Done retime(const SolveArgs& args, StoredRun& run) {
  if (auto checked = check_times(args.fps, args.slow_motion); !checked) return checked;
  ObservationLog& seen = run.seen;
  if (args.fps || args.slow_motion) {
    const double factor = args.slow_motion.value_or(seen.input.slow_motion);
    const double stretch = seen.input.slow_motion / factor;
    const auto time_of = [&](const Observation& frame) {
      return args.fps ? static_cast<double>(frame.frame) / *args.fps / factor : frame.time_s * stretch;
    };
    for (std::size_t n = 0; n < seen.observations.size(); ++n) {
      Observation frame = seen.observations[n];
      frame.time_s = time_of(frame);
      seen.observations.replace(n, frame);
    }
    if (seen.reference) seen.reference->seen.time_s = time_of(seen.reference->seen);
    seen.input.fps = args.fps ? *args.fps * factor : seen.input.fps / stretch;
    seen.input.slow_motion = factor;
    if (args.fps) seen.input.time_source = "fps-option";
    if (args.fps) std::erase(seen.notes, kNoTimesNote);
  }
  if (const auto problem = time_problem(run.options, seen.input)) return usage(*problem);
  return {};
}

// Reads the observations of a run. A killed run has no end and no results, so its kept frames are used. If there are
// results, a file without an end is damaged.
tl::expected<StoredRun, std::string> run_in(const std::string& folder) {
  namespace fs = std::filesystem;
  const std::string path = (fs::path(folder) / kRunFileName).string();
  std::error_code error;
  if (const std::string kind = kind_unless_plain(path); fs::exists(path, error) && !kind.empty())
    return tl::unexpected(
        fmt::format("there are no observations: {} is {}: give a folder that `measure` wrote", path, kind));
  if (!fs::exists(path, error) || fs::exists(fs::path(folder) / "run.json", error)) return read_run(path);
  auto kept = recover_run(path);
  if (!kept) return tl::unexpected(kept.error());
  if (kept->run.options.method == nullptr)
    return tl::unexpected(fmt::format("the run was stopped before its first frame: {}: measure again", path));
  if (!kept->has_end)
    kept->run.seen.notes.push_back(
        fmt::format("the results end after the first {} of its frames, because the run was not finished. Finish it "
                    "with measure --resume",
                    kept->run.seen.observations.size()));
  return std::move(kept->run);
}

Done choose_readout(const SolveArgs& args, MeasureOptions& options) {
  if (args.readout.empty()) return {};
  const auto readout = readout_time(args.readout);
  if (!readout) return tl::unexpected(readout.error());
  options.solve.readout_s = *readout;
  return {};
}

tl::unexpected<RunFailure> failed(Exit exit, std::string message) {
  return tl::unexpected(RunFailure{exit, std::move(message)});
}

}  // namespace

tl::expected<StoredRun, RunFailure> run_to_solve(const SolveArgs& typed, RunBase base) {
  auto stored = run_in(typed.run);
  if (!stored) return failed(Exit::kInputUnreadable, stored.error());
  complete_markers(stored->seen);
  SolveArgs args = typed;
  if (base == RunBase::kResults) {
    std::ifstream json(std::filesystem::path(args.run) / "run.json");
    if (const auto results = options_of_results(json))
      args = with_options_of_results(std::move(args), *results, *stored);
  }
  for (const Done& done : {choose_method(args, stored->options), choose_rest(args, stored->options),
                           choose_zero(args, stored->options), choose_readout(args, stored->options),
                           retime(args, *stored), restate(args, *stored), choose_among_markers(args, *stored)}) {
    if (!done) return failed(Exit::kUsage, done.error().message);
  }
  return *std::move(stored);
}

tl::expected<SolvedResults, RunFailure> solve_in_memory(const SolveArgs& args, RunBase base) {
  auto stored = run_to_solve(args, base);
  if (!stored) return tl::unexpected(stored.error());
  SolvedResults solved{{}, std::move(stored->options), {}};
  static_cast<ObservationLog&>(solved.measurement) = std::move(stored->seen);
  evaluate(solved.options, solved.measurement);
  if (!solved.measurement.contradiction.empty())
    return failed(Exit::kUsage, solved.measurement.contradiction + ": give other frames, or none");
  return solved;
}

tl::expected<void, RunFailure> check_results(const std::string& folder, const Site& site, const Samples& samples) {
  namespace fs = std::filesystem;
  const std::string path = (fs::path(folder) / "displacement.csv").string();
  std::error_code error;
  if (!fs::exists(path, error) || !kind_unless_plain(path).empty())
    return failed(Exit::kInputUnreadable,
                  fmt::format("the run has no results: {} does not exist: finish it with measure --resume, or give a "
                              "folder that `measure` wrote",
                              path));
  std::ifstream file(path, std::ios::binary);
  const std::string written{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (written == displacement_csv(site, samples)) return {};
  return failed(Exit::kUsage,
                fmt::format("the results have other values than the observations give: {}: repeat here the --site or "
                            "--camera of `solve`, or run `moiregauge solve` again",
                            path));
}

tl::expected<SolvedResults, RunFailure> run_solve(const SolveArgs& args, const RunCallbacks& callbacks) {
  auto figures = figure_formats(args.figures);
  if (!figures) return failed(Exit::kUsage, figures.error().message);
  auto stored = run_to_solve(args);
  if (!stored) return tl::unexpected(stored.error());
  const std::string output = args.output.empty() ? args.run : args.output;
  RunDirectory directory = RunDirectory::solved_from(place_of_run(output), args.run, report_page);
  directory.also(put_figures(*std::move(figures), callbacks));
  if (const auto free = directory.check([&] { return stored->seen.input.sha256; }); !free)
    return tl::unexpected(failure_of(free.error()));
  SolvedResults solved{{}, std::move(stored->options), output};
  static_cast<ObservationLog&>(solved.measurement) = std::move(stored->seen);
  const long frames = static_cast<long>(solved.measurement.observations.size());
  (void)callbacks.may_continue({Stage::kSolving, frames, frames, std::nullopt});
  evaluate(solved.options, solved.measurement);
  if (!solved.measurement.contradiction.empty())
    return failed(Exit::kUsage,
                  solved.measurement.contradiction + ": give other frames, or none (nothing was written)");
  if (const auto written = directory.write(solved.measurement, solved.options); !written)
    return tl::unexpected(failure_of(written.error()));
  return solved;
}

}  // namespace moiregauge::internal
