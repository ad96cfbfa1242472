// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/clip_job.h"

#include <cmath>
#include <csignal>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/io/run_dir/unfinished_run.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal {
namespace {

// A decoder that is stuck is noticed after 10 s of silence (decoder/video_source.h). Only then can `measure` end.
constexpr std::chrono::seconds kPatience{15};
constexpr int kSignalBase = 128;  // exit codes of shells for signals
constexpr int kNotStarted = 127;  // that of the loader of shared libraries

std::string limit_text(const ClipState& state, const std::string& run) {
  if (state.is_timed_out)
    return fmt::format("the time limit ended the measurement: {} (after {:.0f} s): raise --time-limit", run,
                       state.wall_s);
  const std::string said = state.message.empty() ? "no message" : state.message;
  // A lack of memory may also end a process in a library, or before it has begun.
  const char* remedy =
      state.memory_limit_bytes > 0 ? "raise --memory-limit, or report it with the input" : "report it with the input";
  if (state.exit_code == kNotStarted) return fmt::format("the process could not start: {} ({}): {}", run, said, remedy);
  if (state.exit_code > kSignalBase && state.exit_code != static_cast<int>(Exit::kInterrupted))
    return fmt::format("the process was ended by signal {}: {} ({}): {}", state.exit_code - kSignalBase, run, said,
                       remedy);
  // A failed allocation is an exception, which `measure` reports.
  if (state.memory_limit_bytes > 0 && state.message.find("bad_alloc") != std::string::npos)
    return fmt::format("the memory limit ended the measurement: {} ({} MB): raise --memory-limit", run,
                       state.memory_limit_bytes / 1'000'000);
  return state.message;
}

}  // namespace

std::vector<std::string> command_of(const std::string& program, const BatchFolder& folder, const Clip& clip,
                                    const ClipOptions& options, Need need) {
  std::vector<std::string> command{program, "measure", clip.input};
  if (!options.names_markers && !clip.site.empty()) command.push_back("--site=" + clip.site);
  command.insert(command.end(), options.measure.begin(), options.measure.end());
  command.push_back("--threads=" + std::to_string(options.threads));
  command.push_back("--out=" + folder.run(clip.name).string());
  command.push_back(need == Need::kRestart ? "--restart" : "--resume");
  command.push_back("--quiet");
  return command;
}

tl::expected<ClipJob, std::string> ClipJob::start(const std::string& program, const BatchFolder& folder,
                                                  const Clip& clip, const ClipOptions& options, Need need) {
  ClipState state;
  state.identity = identity_of(clip, options);
  state.identity.fingerprint = fingerprint_of(clip);
  state.exit_code = static_cast<int>(Exit::kInterrupted);
  state.time_limit_s = options.time_limit_s;
  state.memory_limit_bytes = options.memory_limit_bytes;
  if (const auto written = write_state(folder, clip.name, state); !written) return tl::unexpected(written.error());
  ChildRequest request;
  request.argv = command_of(program, folder, clip, options, need);
  request.max_memory_bytes = options.memory_limit_bytes;
  request.max_time = std::chrono::milliseconds(static_cast<std::int64_t>(std::ceil(1e3 * options.time_limit_s)));
  request.patience = kPatience;
  auto started = RunningProgram::start(request);
  if (!started) return tl::unexpected(started.error());
  return ClipJob(*std::move(started), folder, clip, std::move(state));
}

void ClipJob::take_messages() {
  constexpr std::string_view kError = "error: ";
  for (const std::string& line : program_.take_stderr_lines()) {
    if (line.starts_with(kError)) state_.message = line.substr(kError.size());
    if (!line.empty()) last_line_ = line;
  }
}

void ClipJob::conclude(const ChildEnd& end) {
  state_.exit_code = end.signal == 0 ? end.exit_code : kSignalBase + end.signal;
  state_.is_timed_out = end.timed_out;
  state_.wall_s = end.wall_s;
  state_.cpu_s = end.cpu_s;
  state_.max_resident_bytes = end.max_resident_bytes;
  // A cluster that takes a task back asks all its processes to stop, and those of the clips may end first. A clip that
  // ended on its own before it noticed the interrupt is finished. So is one that the system ended (SIGKILL).
  const bool was_asked = state_.exit_code == static_cast<int>(Exit::kInterrupted) || end.signal == SIGTERM ||
                         end.signal == SIGINT || end.signal == SIGHUP;
  const bool was_stopped = was_asked || (is_interrupted_ && end.signal != 0);
  // Another process began to measure the clip after this batch had looked.
  const bool is_in_use = state_.exit_code == static_cast<int>(Exit::kUsage) && state_.message.starts_with(kRunInUse);
  state_.is_finished = (state_.is_timed_out && !is_interrupted_) || !(was_stopped || is_in_use);
  if (state_.exit_code == static_cast<int>(Exit::kMeasured)) state_.message.clear();
  if (state_.exit_code != static_cast<int>(Exit::kMeasured) && state_.message.empty()) state_.message = last_line_;
  state_.message = limit_text(state_, folder_.run(clip_.name).string());
}

tl::expected<std::optional<ClipState>, std::string> ClipJob::poll() {
  const auto end = program_.wait(std::chrono::milliseconds(0));
  take_messages();
  if (!end) return std::optional<ClipState>{};
  conclude(*end);
  if (const auto written = write_state(folder_, clip_.name, state_); !written) return tl::unexpected(written.error());
  return std::optional<ClipState>{state_};
}

void ClipJob::interrupt() {
  is_interrupted_ = true;
  program_.stop(kPatience);
}

}  // namespace moiregauge::internal
