// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/layer_choices.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

// Largest number of layers of which all subsets are computed: 16 of them. Chosen.
constexpr std::size_t kMaxFreeLayers = 4;

DerivedColumn column_of(const Channel& channel, const LayeredSeries& series) {
  DerivedColumn column{channel.name, series.unit, channel.text, {}, {}, series.status};
  column.value.assign(series.value.begin(), series.value.end());
  column.u.assign(series.u.begin(), series.u.end());
  return column;
}

using Subset = std::vector<bool>;

std::vector<Subset> all_subsets(std::size_t layers) {
  std::vector<Subset> subsets;
  for (std::size_t bits = 0; bits < std::size_t{1} << layers; ++bits) {
    Subset subset(layers);
    for (std::size_t k = 0; k < layers; ++k) subset[k] = (bits >> k & 1U) != 0;
    subsets.push_back(std::move(subset));
  }
  return subsets;
}

std::vector<Subset> first_layers(std::size_t layers) {
  std::vector<Subset> subsets;
  for (std::size_t count = 0; count <= layers; ++count) {
    Subset subset(layers, false);
    std::fill_n(subset.begin(), count, true);
    subsets.push_back(std::move(subset));
  }
  return subsets;
}

// Returns the largest list of subsets whose values are at most `max_values`.
std::vector<Subset> subsets_within(std::size_t layers, double values, double max_values) {
  const auto fits = [&](std::size_t count) { return static_cast<double>(count) * values <= max_values; };
  if (layers <= kMaxFreeLayers && fits(std::size_t{1} << layers)) return all_subsets(layers);
  if (fits(layers + 1)) return first_layers(layers);
  if (fits(2)) return {Subset(layers, false), Subset(layers, true)};
  return {Subset(layers, true)};
}

}  // namespace

tl::expected<LayeredChannels, std::string> layered_channels(const std::vector<Channel>& channels,
                                                            const std::vector<ChannelSeries>& series,
                                                            const std::vector<Layer>& layers) {
  LayeredChannels out;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const auto whole = layered(series[k], channels[k].unit, layers);
    if (!whole) return tl::unexpected(fmt::format("the channel {} has no series: {}", channels[k].name, whole.error()));
    out.table.frame = whole->frame;
    out.table.time_s = whole->time_s;
    out.table.columns.push_back(column_of(channels[k], *whole));
    out.statistics.push_back(statistics_of(*whole));
  }
  return out;
}

std::vector<LayerChoice> layer_choices(const std::vector<Channel>& channels, const std::vector<ChannelSeries>& series,
                                       const std::vector<Layer>& layers, double max_values) {
  std::vector<LayerChoice> choices;
  if (channels.empty()) return choices;
  const double values = static_cast<double>(series.front().size()) * static_cast<double>(channels.size());
  for (const Subset& subset : subsets_within(layers.size(), values, max_values)) {
    std::vector<Layer> chosen;
    for (std::size_t k = 0; k < layers.size(); ++k) {
      if (subset[k]) chosen.push_back(layers[k]);
    }
    auto computed = layered_channels(channels, series, chosen);
    if (computed) choices.push_back({subset, *std::move(computed)});
  }
  return choices;
}

}  // namespace moiregauge::internal
