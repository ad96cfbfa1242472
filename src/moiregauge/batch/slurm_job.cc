// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/slurm_job.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/child_process.h"
#include "moiregauge/batch/clip_state.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMinChunk = 10;
constexpr std::chrono::seconds kSubmitTime{60};

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

// In names of output files Slurm replaces `%` and a letter.
std::string without_patterns(const std::string& path) {
  std::string result;
  for (const char c : path) result += c == '%' ? std::string("%%") : std::string(1, c);
  return result;
}

// Numbers the submissions, because tasks of an earlier one may still read its manifest.
fs::path next_submission(const BatchFolder& folder) {
  std::error_code ignored;
  int number = 1;
  while (fs::exists(folder.slurm() / fmt::format("{}.jsonl", number), ignored)) ++number;
  return folder.slurm() / std::to_string(number);
}

std::string script_text(const SlurmRequest& request, const fs::path& manifest, std::size_t tasks) {
  return fmt::format("#!/bin/sh\nexec {} batch --task \"$SLURM_ARRAY_TASK_ID/{}\" --manifest {}{}\n",
                     quoted(request.program), tasks, quoted(manifest.string()), request.retry ? " --retry" : "");
}

std::vector<std::string> sbatch_command(const SlurmRequest& request, const fs::path& submission, std::size_t tasks) {
  const std::string limit = request.max_running > 0 ? fmt::format("%{}", request.max_running) : "";
  std::vector<std::string> command{"/usr/bin/env",
                                   "sbatch",
                                   "--parsable",
                                   "--requeue",
                                   "--open-mode=append",
                                   "--job-name=moiregauge",
                                   fmt::format("--array=1-{}{}", tasks, limit),
                                   "--output=" + without_patterns(submission.string()) + "-%a.log"};
  if (request.options.threads > 1) command.push_back(fmt::format("--cpus-per-task={}", request.options.threads));
  command.insert(command.end(), request.sbatch.begin(), request.sbatch.end());
  command.push_back(submission.string() + ".sh");
  return command;
}

// Returns the number of the job. Fails with the last message of sbatch.
tl::expected<std::string, std::string> submit(const std::vector<std::string>& command) {
  ChildRequest request;
  request.argv = command;
  request.max_time = kSubmitTime;
  request.reads_stdout = true;
  auto sbatch = RunningProgram::start(request);
  if (!sbatch) return tl::unexpected(sbatch.error());
  const auto end = sbatch->wait(2 * kSubmitTime);
  const auto messages = sbatch->take_stderr_lines();
  const std::string output = sbatch->take_stdout();
  if (end && end->exit_code == 0) return output.substr(0, output.find_first_of(";\n"));  // "12;cluster"
  if (end && end->exit_code == 127) return tl::unexpected(std::string("there is no sbatch on this computer"));
  return tl::unexpected(messages.empty() ? std::string("it does not answer") : messages.back());
}

std::vector<Clip> unfinished(const SlurmRequest& request, const std::vector<Clip>& clips) {
  std::vector<Clip> result;
  for (const Clip& clip : clips) {
    const auto state = read_state(request.folder, clip.name);
    if (need_of(clip, request.options, state, request.retry) != Need::kNothing) result.push_back(clip);
  }
  return result;
}

}  // namespace

std::size_t default_chunk(std::size_t clips) { return std::max(kMinChunk, (clips + kMaxTasks - 2) / (kMaxTasks - 1)); }

tl::expected<SubmittedJob, SlurmFailure> submit_job(const SlurmRequest& request, const std::vector<Clip>& clips) {
  const auto failed = [](bool is_usage, std::string message) {
    return tl::unexpected(SlurmFailure{is_usage, std::move(message)});
  };
  const Manifest manifest{request.options, unfinished(request, clips)};
  SubmittedJob job{"", manifest.clips.size(), 0};
  if (job.clips == 0) return job;
  const std::size_t chunk = request.chunk > 0 ? request.chunk : default_chunk(job.clips);
  job.tasks = (job.clips + chunk - 1) / chunk;
  if (job.tasks > kMaxTasks)
    return failed(
        true, fmt::format("there are too many tasks: --chunk {} ({} tasks, Slurm allows {}): use --chunk {} or more",
                          chunk, job.tasks, kMaxTasks, default_chunk(job.clips)));
  const fs::path submission = next_submission(request.folder);
  const std::string manifest_file = submission.string() + ".jsonl";
  auto written = write_manifest(manifest_file, manifest);
  if (written)
    written = write_file_atomically(submission.string() + ".sh", script_text(request, manifest_file, job.tasks));
  if (!written)
    return failed(false, fmt::format("the job cannot be written: {}: free space, or choose another folder with -o",
                                     written.error()));
  const auto id = submit(sbatch_command(request, submission, job.tasks));
  if (!id)
    return failed(
        true,
        fmt::format("Slurm did not accept the job: sbatch ({}): change its options with --sbatch, or omit --slurm",
                    id.error()));
  job.id = *id;
  return job;
}

std::optional<TaskNumber> task_number(const std::string& text) {
  TaskNumber task;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, task.number);
  if (number.ec != std::errc{} || number.ptr == end || *number.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(number.ptr + 1, end, task.count);
  if (count.ec != std::errc{} || count.ptr != end || task.number < 1 || task.number > task.count) return std::nullopt;
  return task;
}

std::vector<Clip> clips_of_task(const std::vector<Clip>& clips, TaskNumber task) {
  std::vector<Clip> result;
  for (std::size_t i = task.number - 1; i < clips.size(); i += task.count) result.push_back(clips[i]);
  return result;
}

BatchFolder folder_of_manifest(const fs::path& manifest) {
  std::error_code ignored;
  return {fs::absolute(manifest, ignored).lexically_normal().parent_path().parent_path().parent_path()};
}

}  // namespace moiregauge::internal
