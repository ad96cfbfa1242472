// SPDX-License-Identifier: Apache-2.0
// run.mgj: what the frames told, kept so that a run can be solved again without them (docs/file-formats.md).
#pragma once

#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// Raised when a stored field changes its meaning, or is added (kAdded of run_layout.h). Versions from 2 on are read.
inline constexpr int kRunFileVersion = 4;
inline constexpr std::string_view kRunFileName = "run.mgj";

// What a run is of, known before its first frame: another one cannot go on with it.
struct RunStart {
  std::string version;        // of the program
  std::string fingerprint;    // of the input's ends (quick_fingerprint of file_hash.h)
  std::optional<double> fps;  // --fps
  bool sequence = false;      // --sequence
  InputInfo input;            // as it was opened
};

struct StoredRun {
  RunStart start;
  MeasureOptions options;
  ObservationLog seen;
};

// The file's parts, in their order: head; frames, with the reference frame before the first one that is measured
// against it (`notes`: what was noted when it was made); the end, which an unfinished run has not. A statement of rest
// says nothing of how frames are looked at, and is known to be true only when all of them were: the head leaves it out,
// and the options it belongs to come once more before the end.
[[nodiscard]] std::string head_bytes(const RunStart& start, MeasureOptions options);
[[nodiscard]] std::string reference_bytes(const Reference& reference, const std::vector<std::string>& notes);
[[nodiscard]] std::string frame_bytes(const std::string& packed);
[[nodiscard]] std::string end_bytes(const ObservationLog& seen, const MeasureOptions& options);

// All of it, or "what: where: what to do". Every byte is checked; nothing is believed of a file that is not whole.
[[nodiscard]] tl::expected<StoredRun, std::string> read_run(const std::string& path);
[[nodiscard]] tl::expected<StoredRun, std::string> parse_run(std::istream& file, const std::string& path);

// What was kept of a run that did not end, or of one that did: everything up to the first record that is torn, damaged
// or makes no sense with those before it.
struct KeptRun {
  StoredRun run;
  std::size_t bytes = 0;           // of the part that is good, without an end: what comes next is written there
  bool has_end = false;            // the last record is there, and nothing behind it
  bool is_of_this_version = true;  // else nothing can be written behind it
};

// Of a file that breaks off in its head, as a kill leaves it, nothing is kept: no bytes, no method. Fails where the
// head is another version's, somebody else's or damaged.
[[nodiscard]] tl::expected<KeptRun, std::string> recover_run(const std::string& path);
[[nodiscard]] tl::expected<KeptRun, std::string> parse_kept_run(std::istream& file, const std::string& path);

}  // namespace moiregauge::internal
