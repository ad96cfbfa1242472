// SPDX-License-Identifier: Apache-2.0
// Where a run's folder stands, and how one is put there as a whole.
#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

struct RunPlace {
  std::string shown;                 // DIR as typed, for messages
  std::filesystem::path results;     // DIR itself, whatever name leads to it
  std::filesystem::path unfinished;  // DIR.unfinished: a run that is under way, or was
  std::filesystem::path solved;      // DIR.solved: new results of `solve`, while they are written
  std::filesystem::path replaced;    // DIR.replaced: what stood in DIR, for the moment of an exchange in two steps
};

[[nodiscard]] RunPlace place_of_run(const std::string& dir);

// After a process was killed while it put a run in its place: DIR is there again.
void recover(const RunPlace& place);

// `folder`, whose files are on the disk, becomes DIR, and what stood there is gone: at no moment, a kill's or a power
// cut's, there is neither (file systems that cannot exchange two folders at once: see mend). Fails with the system's
// words.
[[nodiscard]] tl::expected<void, std::string> publish(const std::filesystem::path& folder, const RunPlace& place);

// Results that were written so far are gone; run.mgj stays.
void keep_journal_only(const std::filesystem::path& folder);

// Of what stands in a folder: does run.json say that the run was interrupted?
[[nodiscard]] bool holds_interrupted_run(const std::filesystem::path& folder);

}  // namespace moiregauge::internal
