// SPDX-License-Identifier: Apache-2.0
// Input: any records as run.mgj. The file header is added, and the check sums are corrected if the first byte is even.
// Requires: an accepted run is the same after writing and reading. The valid part of a truncated file is itself valid.
#include "moiregauge/io/journal/run_file.h"

#include <algorithm>
#include <sstream>

#include "moiregauge/base/crc32.h"
#include "moiregauge/io/journal/stored_bytes.h"
#include "tests/fuzz/input_file.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kHeader = 16, kRecordHead = 8, kSum = 4;  // bytes

// Returns the bytes of a run. The reference follows the last frame without its markers.
std::string written(const StoredRun& run) {
  const auto& frames = run.seen.observations;
  std::size_t before = 0;
  for (std::size_t i = 0; run.seen.reference && i < frames.size(); ++i) {
    if (frames[i].markers.size() != run.seen.reference->site.markers.size()) before = i + 1;
  }
  std::string file = head_bytes(run.start, run.options);
  for (std::size_t i = 0; i <= frames.size(); ++i) {
    if (run.seen.reference && i == before) file += reference_bytes(*run.seen.reference, run.seen.notes);
    if (i < frames.size()) file += frame_bytes(frames.packed(i));
  }
  return file + end_bytes(run.seen, run.options);
}

template <typename Parse>
auto parsed(const std::string& file, Parse parse) {
  std::istringstream stream(file);
  return parse(stream, "f");
}

void sign_records(std::string& file) {
  for (std::size_t at = kHeader; at + kRecordHead + kSum <= file.size();) {
    const std::size_t length = from_little_endian(std::string_view(file).substr(at + 4, 4));
    if (length > file.size() - at - kRecordHead - kSum) return;
    const std::size_t end = at + kRecordHead + length;
    std::string sum;
    append_little_endian(sum, crc32(std::string_view(file).substr(at, end - at)), kSum);
    file.replace(end, kSum, sum);
    at = end + kSum;
  }
}

// Reads the file as the journal of a killed run. The valid part must be a prefix, and must be valid without the rest.
void recover(const std::string& file) {
  const auto kept = parsed(file, parse_kept_run);
  if (!kept) return fuzz::demand(!kept.error().empty());
  fuzz::demand(kept->bytes <= file.size() && (!kept->has_end || kept->bytes > 0));
  if (kept->bytes == 0) return;
  fuzz::demand(kept->run.options.method != nullptr);
  const auto again = parsed(file.substr(0, kept->bytes), parse_kept_run);
  fuzz::demand(again.has_value() && again->bytes == kept->bytes && !again->has_end);
  fuzz::demand(again->run.seen.observations.size() == kept->run.seen.observations.size());
}

}  // namespace
}  // namespace moiregauge::internal

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  if (size == 0) return 0;
  static const std::string header = head_bytes({}, {}).substr(0, kHeader);
  std::string file = header + fuzz::text_of({data + 1, size - 1});
  if (data[0] % 2 == 0) sign_records(file);
  recover(file);
  const auto run = parsed(file, parse_run);
  if (!run) {
    fuzz::demand(!run.error().empty());
    return 0;
  }
  const std::string once = written(*run);
  const auto again = parsed(once, parse_run);
  fuzz::demand(again.has_value() && written(*again) == once);
  return 0;
}
