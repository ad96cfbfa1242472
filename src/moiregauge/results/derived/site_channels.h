// SPDX-License-Identifier: Apache-2.0
// Channels of a site file: their names follow the choice of markers, and those that the targets allow are read.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "moiregauge/results/derived/channel.h"
#include "moiregauge/results/derived/channel_parser.h"
#include "moiregauge/site/marker_choice.h"

namespace moiregauge::internal {

struct SiteChannels {
  std::vector<Channel> channels;
  std::vector<ChannelText> texts;  // the same channels as text
  // Channels that are no longer possible, such as those of a target that is not measured: name and reason.
  std::vector<std::string> omitted;
};

// Returns the names of the site's targets with a grating, in the site's order.
[[nodiscard]] std::vector<std::string> target_names(const Site& site);

// Reads the channels that `targets` allow.
[[nodiscard]] SiteChannels read_site_channels(std::span<const ChannelText> texts, std::span<const std::string> targets);

// Returns the channels with the new names of the site's targets. A channel that cannot be read stays as it is.
[[nodiscard]] std::vector<ChannelText> renamed_channels(std::vector<ChannelText> texts, const Site& site,
                                                        std::span<const NewName> names);

}  // namespace moiregauge::internal
