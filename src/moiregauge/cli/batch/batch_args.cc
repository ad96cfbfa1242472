// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/batch/batch_args.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "moiregauge/app/run_figures.h"
#include "moiregauge/base/duration_text.h"
#include "moiregauge/base/size_text.h"
#include "moiregauge/cli/measure/command_measure.h"

namespace moiregauge::internal::cli {
namespace {

constexpr double kDefaultTimeLimit_s = 4.0 * 3600.0;

void add_running(CLI::App& command, BatchArgs& args) {
  command.add_option("INPUTS", args.inputs, "videos, folders with videos or images below, lists @clips.txt")
      ->type_name("FILE");
  command.add_option("-o,--out", args.output, "folder of the batch: one run directory per clip")->type_name("DIR");
  command.add_option("--jobs", args.jobs, "clips measured at the same time; with --slurm: tasks [processors]")
      ->check(CLI::Range(1, 4096).description(""))
      ->type_name("N");
  command.add_option("--time-limit", args.time_limit, "time after which a clip is stopped, resumable; 0s: none [4h]")
      ->type_name("TIME");
  command
      .add_option("--memory-limit", args.memory_limit,
                  "memory of each process, e.g. 2GB; none: no limit [the computer's, divided by --jobs]")
      ->type_name("SIZE");
  command.add_flag("--retry", args.retry, "also measure clips again that failed or were refused");
  command.add_flag("--quiet", args.quiet, "print nothing but errors");
}

void add_cluster(CLI::App& command, BatchArgs& args) {
  command.add_flag("--slurm", args.slurm, "submit the clips as one Slurm job array instead of measuring here");
  command.add_option("--chunk", args.chunk, "clips of one Slurm task [10, or more for over 9990 clips]")
      ->check(CLI::Range(1, 1'000'000).description(""))
      ->type_name("N");
  command.add_option("--sbatch", args.sbatch, "an option for sbatch, e.g. --sbatch=--partition=long; repeatable")
      ->allow_extra_args(false)
      ->type_name("OPTION");
  command.add_flag("--collect", args.collect, "only write batch.csv, catalogue.sqlite and index.html again");
  command.add_option("--query", args.query, "print the result of a SELECT on the catalogue as CSV")->type_name("SQL");
  command.add_option("--task", args.task, "measure part I of N of a manifest: the command of a Slurm task")
      ->type_name("I/N");
  command.add_option("--manifest", args.manifest, "the manifest of --task")->type_name("FILE");
}

// A task of Slurm may run in another folder.
std::string absolute_if_path(const std::string& option, const std::string& value) {
  std::error_code ignored;
  const bool is_path = option == "--site" || option == "--camera";
  return is_path ? std::filesystem::absolute(value, ignored).lexically_normal().string() : value;
}

// Returns the given options as one argument each, so that no value can look like an option.
std::vector<std::string> as_typed(const std::vector<CLI::Option*>& options) {
  std::vector<std::string> arguments;
  for (const CLI::Option* option : options) {
    if (option->count() == 0) continue;
    const std::string name = "--" + option->get_lnames().front();
    if (option->get_items_expected_max() == 0)
      arguments.push_back(name);
    else if (option->get_delimiter() != '\0')
      arguments.push_back(fmt::format("{}={}", name, fmt::join(option->results(), ",")));
    else
      for (const std::string& value : option->results())
        arguments.push_back(fmt::format("{}={}", name, absolute_if_path(name, value)));
  }
  return arguments;
}

tl::expected<double, UsageError> time_limit(const std::string& text) {
  if (text.empty()) return kDefaultTimeLimit_s;
  const auto seconds = long_duration_s(text);
  if (!seconds) return usage(fmt::format("the time limit cannot be read: --time-limit {}: {}", text, seconds.error()));
  return *seconds;
}

// The sanitizer's shadow memory would count as the program's.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

tl::expected<std::int64_t, UsageError> memory_limit(const BatchArgs& args) {
  if (args.memory_limit == "none" || (args.memory_limit.empty() && !kLimitsMemory)) return std::int64_t{0};
  if (args.memory_limit.empty())
    return std::int64_t{::sysconf(_SC_PHYS_PAGES)} * ::sysconf(_SC_PAGESIZE) /
           std::max(1, shares_of(args, SIZE_MAX).jobs);
  const auto bytes = byte_count(args.memory_limit);
  if (!bytes)
    return usage(fmt::format("the memory limit cannot be read: --memory-limit {}: write it like 500MB or 2GB, or none",
                             args.memory_limit));
  return static_cast<std::int64_t>(*bytes);
}

// Checks options that must not be given, or given together.
tl::expected<void, UsageError> check_task(const BatchArgs& args) {
  if (args.manifest.empty())
    return usage(fmt::format("the manifest is missing: --task {}: add --manifest FILE", args.task));
  if (!args.inputs.empty() || args.slurm || args.collect || !args.query.empty() || !args.output.empty())
    return usage("a task takes its clips from the manifest: --task: omit INPUTS, -o, --slurm, --collect and --query");
  return {};
}

}  // namespace

void add_batch_options(CLI::App& command, BatchArgs& args) {
  add_running(command, args);
  const auto own = command.get_options().size();
  for (const auto add :
       {add_print_options, add_camera_options, add_frame_options, add_method_options, add_drawing_options})
    add(command, args.measure);
  const auto all = command.get_options();
  for (std::size_t i = own; i < all.size(); ++i)
    if (all[i]->get_lnames().front() != "threads") args.measure_options.push_back(all[i]);
  add_cluster(command, args);
}

tl::expected<BatchMode, UsageError> batch_mode(const BatchArgs& args) {
  if (!args.task.empty()) return check_task(args).map([] { return BatchMode::kTask; });
  if (!args.manifest.empty()) return usage("there is no task: --manifest: add --task I/N");
  if (args.output.empty()) return usage("the folder of the batch is missing: batch: add -o DIR");
  const int modes = args.slurm + args.collect + !args.query.empty();
  if (modes > 1) return usage("the options contradict each other: --slurm, --collect and --query: give one of them");
  if (!args.slurm && (args.chunk > 0 || !args.sbatch.empty()))
    return usage("these options are for Slurm: --chunk and --sbatch: add --slurm");
  if (args.collect || !args.query.empty()) {
    if (!args.inputs.empty())
      return usage(
          fmt::format("no clip is measured: {} with INPUTS: omit the INPUTS", args.collect ? "--collect" : "--query"));
    return args.collect ? BatchMode::kCollect : BatchMode::kQuery;
  }
  if (args.inputs.empty()) return usage("the clips are missing: INPUTS: give videos, folders, or a list @clips.txt");
  return args.slurm ? BatchMode::kSlurm : BatchMode::kMeasure;
}

tl::expected<ClipOptions, UsageError> clip_options(const BatchArgs& args) {
  MeasureArgs checked = args.measure;
  ClipOptions options;
  options.names_markers = !checked.site.empty() || !checked.pitch.empty();
  // The site file next to a clip is read with the clip. The other options are checked now.
  if (!options.names_markers) checked.pitch = "10mm";
  if (const auto parsed = parse_measure_options(checked); !parsed) return tl::unexpected(parsed.error());
  if (const auto figures = figure_formats(checked.figures); !figures) return tl::unexpected(figures.error());
  const auto time = time_limit(args.time_limit);
  if (!time) return tl::unexpected(time.error());
  const auto memory = memory_limit(args);
  if (!memory) return tl::unexpected(memory.error());
  options.measure = as_typed(args.measure_options);
  options.time_limit_s = *time;
  options.memory_limit_bytes = *memory;
  return options;
}

Shares shares_of(const BatchArgs& args, std::size_t clips) {
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int wanted = args.jobs > 0 ? args.jobs : processors;
  Shares shares;
  shares.jobs = static_cast<int>(std::min(clips, static_cast<std::size_t>(wanted)));
  shares.threads = args.measure.threads > 0 ? args.measure.threads : std::max(1, processors / std::max(1, shares.jobs));
  return shares;
}

int jobs_of_task(const BatchArgs& args) {
  if (args.jobs > 0) return args.jobs;
  const char* const stated = std::getenv("SLURM_CPUS_PER_TASK");
  if (stated == nullptr) return 1;
  const std::string_view text = stated;
  int processors = 1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), processors);
  return error == std::errc{} && processors > 0 ? processors : 1;
}

}  // namespace moiregauge::internal::cli
