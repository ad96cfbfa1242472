// SPDX-License-Identifier: Apache-2.0
// Input: any text as a channel of `derive`.
// Requires: a channel is finite, has terms, a name and a unit. A mistake has a column within the text and two parts
// without a line end.
#include "moiregauge/results/derived/channel_parser.h"

#include <cmath>

#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const std::string text = fuzz::text_of({data, size});
  const std::vector<std::string> targets{"mid", "left", "span 2"};
  const Channel earlier{"tilt", "mrad", {{TermKind::kLineRotation, {0, 1}, 1.0}}, 0.0, "rotation(mid, left)"};
  const auto channel = parse_channel(text, targets, std::span(&earlier, 1));
  if (!channel) {
    const ChannelMistake& mistake = channel.error();
    fuzz::demand(mistake.column >= 1 && mistake.column <= text.size() + 1 && !mistake.what.empty());
    fuzz::demand((mistake.what + mistake.remedy).find('\n') == std::string::npos && !mistake.remedy.empty());
    return 0;
  }
  fuzz::demand(!channel->name.empty() && !channel->unit.empty() && !channel->terms.empty());
  fuzz::demand(channel->terms.size() <= kMaxChannelTerms + 1 && std::isfinite(channel->constant));
  for (const ChannelTerm& term : channel->terms) {
    fuzz::demand(std::isfinite(term.factor) && !term.targets.empty());
    for (const std::size_t target : term.targets) fuzz::demand(target < targets.size());
  }
  return 0;
}
