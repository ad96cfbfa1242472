// SPDX-License-Identifier: Apache-2.0
// Paths of a run's folder, and its atomic replacement.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace moiregauge::internal {

struct RunPlace {
  std::string shown;                 // DIR as typed, for messages
  std::filesystem::path results;     // DIR itself, symbolic links resolved
  std::filesystem::path unfinished;  // DIR.unfinished: a run in progress or interrupted
  std::filesystem::path solved;      // DIR.solved: new results of `solve` while they are written
  std::filesystem::path replaced;    // DIR.replaced: the old DIR during an exchange in two steps
};

[[nodiscard]] RunPlace place_of_run(const std::string& dir);

// Restores DIR after a process was killed while it replaced DIR.
void recover(const RunPlace& place);

// Makes the synced `folder` the new DIR and deletes the old one. One of them exists at any moment, also after a kill or
// power cut. File systems that cannot exchange two folders at once need recover() for that. Fails with the system's
// message.
[[nodiscard]] tl::expected<void, std::string> publish(const std::filesystem::path& folder, const RunPlace& place);

// Provisional rows of `live`, as they were published.
inline constexpr std::string_view kLiveRowsName = "live.csv";
// Settings and losses of `live`.
inline constexpr std::string_view kLiveFactsName = "live.json";

// Deletes the results in a folder. run.mgj and live.csv stay.
void keep_journal_only(const std::filesystem::path& folder);

// Returns true if run.json in this folder says that the run was interrupted.
[[nodiscard]] bool holds_interrupted_run(const std::filesystem::path& folder);

}  // namespace moiregauge::internal
