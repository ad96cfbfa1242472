// SPDX-License-Identifier: Apache-2.0
// Any text as site.toml: a site that is written again as it was read, or mistakes with their places.
#include "moiregauge/io/config/site_file.h"

#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const auto site = parse_site(fuzz::text_of({data, size}), "f");
  if (!site) {
    for (const std::string& line : site.error()) fuzz::demand(line.starts_with("f:") && line.find('\n') == line.npos);
    fuzz::demand(!site.error().empty());
    return 0;
  }
  const std::string written = write_site(*site);
  const auto again = parse_site(written, "f");
  if (!again && written.size() > 60000) return 0;  // too long for a site by now
  fuzz::demand(again.has_value() && again->markers.size() == site->markers.size());
  return 0;
}
