// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "moiregauge/server/jobs/job_arguments.h"

namespace moiregauge::internal {

enum class JobState { kQueued, kRunning, kDone, kFailed, kCancelled };
[[nodiscard]] const char* word_for(JobState state);

// One command as the page sees it.
struct Job {
  std::string id;
  JobCommand command;
  JobState state = JobState::kQueued;
  std::optional<int> exit_code;
  long frames_done = 0;
  long frames = -1;  // -1: unknown
  double seconds = 0.0;
  std::string stage;              // "measuring", "solving"; empty: not reported
  std::deque<std::string> lines;  // messages, the newest 20
  std::string live_line;          // newest JSON line of `live`

  [[nodiscard]] bool has_ended() const { return state != JobState::kQueued && state != JobState::kRunning; }
  void add_line(std::string line);
};

// Returns a job as JSON.
[[nodiscard]] std::string job_json(const Job& job);
// Returns the name of the file with the newest picture of a live source. Hidden, so that no address of the page shows it.
[[nodiscard]] std::string preview_name(const Job& job);
// Returns an event of the stream. `data` is JSON without line ends.
[[nodiscard]] std::string event_text(std::string_view name, std::string_view data);
// Returns the command line for a shell: "moiregauge measure clip.mp4 --pitch 10mm".
[[nodiscard]] std::string command_line(const JobCommand& command);
// Returns the words as one line for a shell. Words with other characters than letters, digits and _@%+=:,./- are quoted.
[[nodiscard]] std::string shell_line(const std::vector<std::string>& words);

// Meaning of a line that a child wrote to stderr.
struct ChildLine {
  enum class Kind { kMessage, kProgress, kSamples, kView } kind = Kind::kMessage;
  std::string text;     // a message
  std::string samples;  // JSON object: rows by marker
  std::string view;     // JSON array of nine numbers: map of image points to the reference frame; null: unknown
  std::string stage;
  long frame = -1;  // frame number of `view`
  long done = 0, expected = -1;
};
// Reads a line of --progress json, or any other message. Never fails: what it does not know is a message.
[[nodiscard]] ChildLine read_child_line(std::string_view line);

}  // namespace moiregauge::internal
