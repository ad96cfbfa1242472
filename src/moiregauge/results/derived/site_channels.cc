// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/site_channels.h"

#include <algorithm>
#include <utility>

namespace moiregauge::internal {
namespace {

// Quotes do not occur in the names of markers.
std::string in_quotes(const std::string& name) { return "'" + name + "'"; }

std::string name_in_expression(const std::string& name) {
  return channel_name_problem(name).empty() ? name : in_quotes(name);
}

}  // namespace

std::vector<std::string> target_names(const Site& site) {
  std::vector<std::string> names;
  for (const Marker& marker : site.markers) {
    if (marker.role == Role::kTarget && marker.grating) names.push_back(marker.name);
  }
  return names;
}

SiteChannels read_site_channels(std::span<const ChannelText> texts, std::span<const std::string> targets) {
  SiteChannels out;
  for (const ChannelText& text : texts) {
    auto channel = parse_channel_value(text.name, text.unit, text.expression, targets, out.channels);
    if (!channel) {
      out.omitted.push_back(text.name + ": " + channel.error().what);
      continue;
    }
    out.channels.push_back(*std::move(channel));
    out.texts.push_back(text);
  }
  return out;
}

std::vector<ChannelText> renamed_channels(std::vector<ChannelText> texts, const Site& site,
                                          std::span<const NewName> names) {
  const std::vector<std::string> targets = target_names(site);
  std::vector<Channel> earlier;
  for (ChannelText& text : texts) {
    auto channel = parse_channel_value(text.name, text.unit, text.expression, targets, earlier);
    if (!channel) continue;
    auto named = targets_named_in(text.expression, targets, earlier);
    earlier.push_back(*std::move(channel));
    if (!named) continue;
    std::reverse(named->begin(), named->end());  // so that earlier positions stay valid
    for (const NamedTarget& at : *named) {
      const auto is_renamed = [&](const NewName& name) { return name.from == targets[at.target]; };
      const auto name = std::find_if(names.begin(), names.end(), is_renamed);
      if (name != names.end()) text.expression.replace(at.first, at.count, name_in_expression(name->to));
    }
  }
  return texts;
}

}  // namespace moiregauge::internal
