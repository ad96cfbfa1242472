// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/seek/seek_plan.h"

#include <algorithm>
#include <cstddef>

namespace moiregauge::internal {
namespace {

// Returns the times of all frames in the order in which they are shown. Empty: a frame has no time, or two have the same.
std::vector<std::int64_t> times_in_order(const std::vector<PacketNote>& packets) {
  std::vector<std::int64_t> times;
  times.reserve(packets.size());
  for (const PacketNote& packet : packets) {
    if (packet.is_hidden) continue;
    if (!packet.shown) return {};
    times.push_back(*packet.shown);
  }
  std::ranges::sort(times);
  if (std::ranges::adjacent_find(times) != times.end()) return {};
  return times;
}

// Returns true if a packet after the key frame is shown before it.
bool has_leading_frames(const std::vector<PacketNote>& packets, std::size_t key) {
  return std::any_of(packets.begin() + static_cast<std::ptrdiff_t>(key), packets.end(),
                     [&](const PacketNote& packet) { return packet.shown && *packet.shown < *packets[key].shown; });
}

}  // namespace

bool is_enough(const std::vector<PacketNote>& packets, long wanted) {
  if (packets.empty() || !packets.back().decoded) return false;
  // No later packet is shown before the time at which this one is decoded.
  const std::int64_t reached = *packets.back().decoded;
  if (static_cast<long>(packets.size()) <= wanted) return false;
  return std::ranges::count_if(packets, [&](const PacketNote& packet) {
           return !packet.is_hidden && packet.shown && *packet.shown < reached;
         }) > wanted;
}

std::optional<SeekPlan> plan_seek(const std::vector<PacketNote>& packets, long wanted, long margin) {
  const std::vector<std::int64_t> times = times_in_order(packets);
  const long latest = wanted - margin;
  if (latest < 1 || wanted >= static_cast<long>(times.size())) return std::nullopt;
  const std::int64_t latest_time = times[static_cast<std::size_t>(latest)];
  std::optional<std::size_t> key, key_before;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (!packets[i].is_key || packets[i].is_hidden || *packets[i].shown > latest_time) continue;
    key_before = key;
    key = i;
  }
  if (!key) return std::nullopt;
  const std::optional<std::size_t> start = has_leading_frames(packets, *key) ? key_before : key;
  if (!start || *start == 0) return std::nullopt;
  const std::int64_t first_time = *packets[*key].shown;
  const auto number = std::ranges::lower_bound(times, first_time) - times.begin();
  return SeekPlan{static_cast<std::int64_t>(*start), first_time, static_cast<long>(number), times.front()};
}

}  // namespace moiregauge::internal
