// SPDX-License-Identifier: Apache-2.0
// Input: any text as an alarm rule of `live`, and as the address of an outlet.
// Requires: a rule is finite, names a marker and releases on the safe side. A mistake has a column within the text. An
// address has a host and no password.
#include "moiregauge/live/publish/alarm_rule.h"

#include <cmath>

#include "moiregauge/live/publish/outlet_url.h"
#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const std::string text = fuzz::text_of({data, size});
  if (const auto url = parse_outlet_url(text)) {
    fuzz::demand(!url->host.empty() && !url->scheme.empty() && url->port >= 0 && url->port <= 65535);
    fuzz::demand(url->user.find(':') == std::string::npos && (url->path.empty() || url->path[0] == '/'));
  }
  const auto rule = parse_alarm_rule(text);
  if (!rule) {
    const AlarmMistake& mistake = rule.error();
    fuzz::demand(mistake.column >= 1 && mistake.column <= text.size() + 1);
    fuzz::demand(!mistake.what.empty() && !mistake.remedy.empty());
    return 0;
  }
  fuzz::demand(!rule->marker.empty() && std::isfinite(rule->level_mm) && std::isfinite(rule->release_mm));
  fuzz::demand(std::isfinite(rule->duration_s) && rule->duration_s >= 0.0);
  fuzz::demand(rule->is_above ? rule->release_mm <= rule->level_mm : rule->release_mm >= rule->level_mm);
  return 0;
}
