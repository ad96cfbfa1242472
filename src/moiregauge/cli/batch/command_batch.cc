// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/batch/command_batch.h"

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/base/child_process.h"
#include "moiregauge/batch/batch_lock.h"
#include "moiregauge/batch/batch_run.h"
#include "moiregauge/batch/catalogue.h"
#include "moiregauge/batch/collect.h"
#include "moiregauge/batch/find_clips.h"
#include "moiregauge/batch/slurm_job.h"
#include "moiregauge/cli/batch/batch_args.h"
#include "moiregauge/cli/batch/batch_display.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/terminal_text.h"

namespace moiregauge::internal::cli {
namespace {

BatchFolder folder_of(const BatchArgs& args) {
  std::error_code ignored;
  return {std::filesystem::absolute(args.output, ignored).lexically_normal()};
}

int fail_interrupted(const BatchProgress& progress, const std::string& folder) {
  return fail(Exit::kInterrupted,
              fmt::format("stopped after {} of {} clips: {}: continue with the same command, or show what is "
                          "finished with --collect",
                          progress.skipped + progress.ended, progress.clips, folder));
}

// Writes table, catalogue and page, and reports the totals.
int collect(const BatchArgs& args, std::size_t skipped) {
  const InterruptGuard guard;
  BatchLine line(args.quiet);
  const auto totals = collect_batch(folder_of(args), [&](std::size_t done) {
    line.show_text(fmt::format("collecting: {} clips", done));
    return !interrupted();
  });
  if (!totals) return fail(Exit::kOutputUnwritable, totals.error());
  if (interrupted())
    return fail(Exit::kInterrupted, fmt::format("stopped while collecting: {}: continue with --collect", args.output));
  if (!args.quiet) print_out(totals_text(*totals, skipped, args.output));
  const Exit exit = exit_of_batch(*totals);
  if (exit == Exit::kRefused)
    return fail(exit,
                fmt::format("no clip was measured: {}: see the messages in {}/batch.csv", args.output, args.output));
  return static_cast<int>(exit);
}

// Clips of the INPUTS with their names, in a folder that is ours.
struct OpenBatch {
  BatchLock lock;
  BatchFolder folder;
  std::vector<Clip> clips;
};

// Fails with an exit code, after printing the message.
tl::expected<OpenBatch, int> open_batch(const BatchArgs& args) {
  const BatchFolder folder = folder_of(args);
  auto found = find_clips(args.inputs, folder.path);
  if (!found) return tl::unexpected(fail(Exit::kInputUnreadable, found.error()));
  auto lock = BatchLock::take(folder);
  if (!lock)
    return tl::unexpected(fail(lock.error().usage ? Exit::kUsage : Exit::kOutputUnwritable, lock.error().message));
  auto named = register_clips(folder, *std::move(found));
  if (!named)
    return tl::unexpected(
        fail(Exit::kOutputUnwritable,
             fmt::format("the clips cannot be listed: {}: choose another folder with -o", named.error())));
  return OpenBatch{*std::move(lock), folder, *std::move(named)};
}

// Measures clips, and shows how many are finished.
tl::expected<BatchEnd, std::string> measure_shown(BatchRequest request, const std::vector<Clip>& clips, bool quiet) {
  const InterruptGuard guard;
  BatchLine line(quiet);
  request.program = own_program();
  request.on_progress = [&](const BatchProgress& progress) {
    line.show(progress);
    return !interrupted();
  };
  auto end = measure_clips(request, clips);
  if (end && !end->is_interrupted) {
    line.clear();
    print_note(busy_text(end->busy, request.folder.path.string()));
  }
  return end;
}

int fail_to_measure(const std::string& problem) {
  return fail(Exit::kOutputUnwritable,
              fmt::format("the batch cannot continue: {}: free space, then give the same command", problem));
}

int measure_here(const BatchArgs& args, ClipOptions options) {
  const auto batch = open_batch(args);
  if (!batch) return batch.error();
  const Shares shares = shares_of(args, batch->clips.size());
  options.threads = shares.threads;
  const auto end =
      measure_shown({"", batch->folder, std::move(options), shares.jobs, args.retry, {}}, batch->clips, args.quiet);
  if (!end) return fail_to_measure(end.error());
  if (end->is_interrupted) return fail_interrupted(end->progress, args.output);
  return collect(args, end->progress.skipped);
}

int submit(const BatchArgs& args, ClipOptions options) {
  const auto batch = open_batch(args);
  if (!batch) return batch.error();
  options.threads = std::max(1, args.measure.threads);
  const auto job = submit_job({own_program(), batch->folder, std::move(options), static_cast<std::size_t>(args.chunk),
                               args.jobs, args.retry, args.sbatch},
                              batch->clips);
  if (!job) return fail(job.error().is_usage ? Exit::kUsage : Exit::kOutputUnwritable, job.error().message);
  if (args.quiet) return 0;
  print_out(
      job->id.empty()
          ? fmt::format("found: {} clips, all finished before\nresult: nothing was submitted\n", batch->clips.size())
          : fmt::format("found: {} clips, {} of them to measure\nresult: Slurm job {} with {} tasks\n",
                        batch->clips.size(), job->clips, job->id, job->tasks));
  print_out(fmt::format("next: moiregauge batch --collect -o {}, at any time\n", args.output));
  return 0;
}

int run_task(const BatchArgs& args) {
  const auto task = task_number(args.task);
  if (!task)
    return fail(Exit::kUsage, fmt::format("the task cannot be read: --task {}: write it like 3/40", args.task));
  auto manifest = read_manifest(args.manifest);
  if (!manifest) return fail(Exit::kUsage, manifest.error());
  const auto clips = clips_of_task(manifest->clips, *task);
  const BatchFolder folder = folder_of_manifest(args.manifest);
  const auto end =
      measure_shown({"", folder, std::move(manifest->options), jobs_of_task(args), args.retry, {}}, clips, args.quiet);
  if (!end) return fail_to_measure(end.error());
  if (end->is_interrupted) return fail_interrupted(end->progress, folder.path.string());
  if (!args.quiet)
    print_out(fmt::format("task {}: {} clips, {} finished before, {} failed\n", args.task, clips.size(),
                          end->progress.skipped, end->progress.failed));
  return 0;  // a clip's failure is its own: Slurm must not see the task as failed
}

int query(const BatchArgs& args) {
  const auto done = query_catalogue(folder_of(args).catalogue(), args.query, put_bytes);
  return done ? 0 : fail(Exit::kUsage, done.error());
}

int collect_only(const BatchArgs& args) {
  const BatchFolder folder = folder_of(args);
  std::error_code ignored;
  if (!std::filesystem::exists(folder.clips(), ignored))
    return fail(Exit::kUsage,
                fmt::format("the folder holds no batch: {}: give the folder of a batch with -o", args.output));
  const auto lock = BatchLock::take(folder);
  if (!lock) return fail(lock.error().usage ? Exit::kUsage : Exit::kOutputUnwritable, lock.error().message);
  return collect(args, 0);
}

int run_batch(const BatchArgs& args) {
  const auto mode = batch_mode(args);
  if (!mode) return fail(Exit::kUsage, mode.error().message);
  if (*mode == BatchMode::kTask) return run_task(args);
  if (*mode == BatchMode::kQuery) return query(args);
  if (*mode == BatchMode::kCollect) return collect_only(args);
  auto options = clip_options(args);
  if (!options) return fail(Exit::kUsage, options.error().message);
  return *mode == BatchMode::kSlurm ? submit(args, *std::move(options)) : measure_here(args, *std::move(options));
}

}  // namespace

void add_batch(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("batch", "Measure many clips, here or on a Slurm cluster, and catalogue them");
  auto args = std::make_shared<BatchArgs>();
  add_batch_options(*command, *args);
  command->callback([args, &exit_code] { exit_code = run_batch(*args); });
}

}  // namespace moiregauge::internal::cli
