// SPDX-License-Identifier: Apache-2.0
// Reads and writes run.mgj, the observations of a run, so that it can be solved again without the video
// (docs/file-formats.md).
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

// Raised when a stored field is added (kAdded of run_layout.h) or changes its meaning. Versions from 2 on can be read.
inline constexpr int kRunFileVersion = 12;
inline constexpr std::string_view kRunFileName = "run.mgj";

// Identity of a run, known before its first frame: only the same run can resume.
struct RunStart {
  std::string version;        // program version
  std::string fingerprint;    // identifies the input (quick_fingerprint of file_hash.h)
  std::optional<double> fps;  // --fps
  bool sequence = false;      // --sequence
  InputInfo input;            // as opened
};

struct StoredRun {
  RunStart start;
  MeasureOptions options;
  ObservationLog seen;
};

// Return the parts of the file, in order: head, frames, end. The reference frame with its notes precedes the first
// frame measured against it.
// An unfinished run has no end. The head omits the statement of rest (--rest), because it does not change the
// observations and can only be checked at the end. Options with such a statement are repeated before the end.
[[nodiscard]] std::string head_bytes(const RunStart& start, MeasureOptions options);
[[nodiscard]] std::string reference_bytes(const Reference& reference, const std::vector<std::string>& notes);
[[nodiscard]] std::string frame_bytes(const std::string& packed);
[[nodiscard]] std::string end_bytes(const ObservationLog& seen, const MeasureOptions& options);

// Reads a complete run. Fails with "what happened: where: what to do". Every byte is checked, and an incomplete file is
// refused.
[[nodiscard]] tl::expected<StoredRun, std::string> read_run(const std::string& path);
[[nodiscard]] tl::expected<StoredRun, std::string> parse_run(std::istream& file, const std::string& path);

// The valid part of a run, finished or not: all records before the first one that is torn, damaged or inconsistent.
struct KeptRun {
  StoredRun run;
  std::size_t bytes = 0;           // size of the valid part without an end: new records go there
  bool has_end = false;            // the end is valid and nothing follows it
  bool is_of_this_version = true;  // otherwise the file cannot be continued
};

// Reads the valid part of a run. If the file ends within its head, as after a kill, the result is empty (no bytes, no
// method).
// Fails if the head is damaged, of another version or of another program.
[[nodiscard]] tl::expected<KeptRun, std::string> recover_run(const std::string& path);
[[nodiscard]] tl::expected<KeptRun, std::string> parse_kept_run(std::istream& file, const std::string& path);

}  // namespace moiregauge::internal
