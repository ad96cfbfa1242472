// SPDX-License-Identifier: Apache-2.0
// Any records as run.mgj. The head is made right and so are the check sums, unless the first byte is odd; what is read
// is written and read again, and says the same.
#include "moiregauge/io/run_file.h"

#include <algorithm>
#include <sstream>

#include "moiregauge/io/crc32.h"
#include "moiregauge/io/stored_bytes.h"
#include "tests/fuzz/input_file.h"

namespace moiregauge {
namespace {

constexpr std::size_t kHeader = 16, kRecordHead = 8, kSum = 4;  // bytes

std::string written(const StoredRun& run) {
  std::string file;
  write_run(run.seen, run.options, [&](std::string_view bytes) { return file += bytes, true; });
  return file;
}

tl::expected<StoredRun, std::string> parsed(const std::string& file) {
  std::istringstream stream(file);
  return parse_run(stream, "f");
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

}  // namespace
}  // namespace moiregauge

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge;
  if (size == 0) return 0;
  static const std::string header = written(StoredRun{}).substr(0, kHeader);
  std::string file = header + fuzz::text_of({data + 1, size - 1});
  if (data[0] % 2 == 0) sign_records(file);
  const auto run = parsed(file);
  if (!run) {
    fuzz::demand(!run.error().empty());
    return 0;
  }
  const std::string once = written(*run);
  const auto again = parsed(once);
  fuzz::demand(again.has_value() && written(*again) == once);
  return 0;
}
