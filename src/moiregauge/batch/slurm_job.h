// SPDX-License-Identifier: Apache-2.0
// Runs a batch on a Slurm cluster: one job array whose tasks share nothing but the folder OUT.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/batch/clip.h"
#include "moiregauge/batch/manifest.h"

namespace moiregauge::internal {

// Slurm's default MaxArraySize is 1001, so the largest index is 1000.
inline constexpr std::size_t kMaxTasks = 1000;

struct SlurmRequest {
  std::string program;
  BatchFolder folder;
  ClipOptions options;
  std::size_t chunk = 0;            // clips of a task. 0: chosen
  int max_running = 0;              // tasks at the same time. 0: as many as Slurm allows
  bool retry = false;               // repeats clips that failed
  std::vector<std::string> sbatch;  // further options of sbatch
};

struct SubmittedJob {
  std::string id;  // empty: every clip is finished, so nothing was submitted
  std::size_t clips = 0, tasks = 0;
};

struct SlurmFailure {
  bool is_usage = false;
  std::string message;  // "what happened: where: what to do"
};

// Returns the number of clips of a task. It is at least ten, because Slurm needs 2 to 4 s for a task. There are at most
// 999 tasks.
[[nodiscard]] std::size_t default_chunk(std::size_t clips);

// Writes the manifest of those clips that need a measurement, and submits the job array. Slurm requeues tasks of lost
// nodes, and each task skips finished clips.
[[nodiscard]] tl::expected<SubmittedJob, SlurmFailure> submit_job(const SlurmRequest& request,
                                                                  const std::vector<Clip>& clips);

// Task `number` of `count`, from 1.
struct TaskNumber {
  std::size_t number = 1, count = 1;
};

// Reads "3/40". Returns nothing for any other text.
[[nodiscard]] std::optional<TaskNumber> task_number(const std::string& text);

// Returns the clips of a task: every count-th one, so that long neighbours are in different tasks.
[[nodiscard]] std::vector<Clip> clips_of_task(const std::vector<Clip>& clips, TaskNumber task);

// Returns OUT of a manifest that submit_job wrote.
[[nodiscard]] BatchFolder folder_of_manifest(const std::filesystem::path& manifest);

}  // namespace moiregauge::internal
