// SPDX-License-Identifier: Apache-2.0
// Channels with any choice of the layers, so that a report can switch each layer on and off.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/results/derived/channel.h"
#include "moiregauge/results/derived/derived_table.h"
#include "moiregauge/results/derived/layers.h"
#include "moiregauge/results/derived/statistics.h"

namespace moiregauge::internal {

struct LayeredChannels {
  DerivedTable table;
  std::vector<ChannelStatistics> statistics;  // in the order of the columns
};

// Applies the layers to every channel. `series`: one per channel.
// Fails with "what: channel: what to do" if a layer cannot be applied.
[[nodiscard]] tl::expected<LayeredChannels, std::string> layered_channels(const std::vector<Channel>& channels,
                                                                          const std::vector<ChannelSeries>& series,
                                                                          const std::vector<Layer>& layers);

struct LayerChoice {
  std::vector<bool> is_on;  // one per layer
  LayeredChannels channels;
};

// Returns the channels for every subset of the layers, in their order: none first, all last. The rows times channels of
// all subsets together are at most `max_values`. If there are more, the first k layers are the subsets, for every k,
// then none and all, then all.
// A subset is omitted if it cannot be computed, for example a filter without the resampling that it needs.
[[nodiscard]] std::vector<LayerChoice> layer_choices(const std::vector<Channel>& channels,
                                                     const std::vector<ChannelSeries>& series,
                                                     const std::vector<Layer>& layers, double max_values);

}  // namespace moiregauge::internal
