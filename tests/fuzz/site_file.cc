// SPDX-License-Identifier: Apache-2.0
// Input: any text as site.toml.
// Requires: an accepted site has the same number of markers and channels after writing and reading; errors have positions.
#include "moiregauge/io/config/site_file.h"

#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const auto site = parse_site_file(fuzz::text_of({data, size}), "f");
  if (!site) {
    for (const std::string& line : site.error()) fuzz::demand(line.starts_with("f:") && line.find('\n') == line.npos);
    fuzz::demand(!site.error().empty());
    return 0;
  }
  const std::string written = write_site(site->site, site->channels);
  const auto again = parse_site_file(written, "f");
  if (!again && written.size() > 60000) return 0;  // writing made the file longer than the limit
  fuzz::demand(again.has_value() && again->site.markers.size() == site->site.markers.size());
  fuzz::demand(again->channels.size() == site->channels.size());
  return 0;
}
