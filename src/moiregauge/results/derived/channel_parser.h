// SPDX-License-Identifier: Apache-2.0
// Reads channels as text, such as "sag = mid.dy - (left.dy + right.dy) / 2" (docs/cli/derive.md).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/results/derived/channel.h"

namespace moiregauge::internal {

// Limits of a channel's text. They bound the work on hostile text.
inline constexpr std::size_t kMaxChannelText = 2000;  // bytes
inline constexpr int kMaxChannelDepth = 32;           // brackets and signs in each other
inline constexpr std::size_t kMaxChannelTerms = 256;
inline constexpr std::size_t kMaxChannels = 64;  // per command and per site file

struct ChannelMistake {
  std::size_t column = 1;  // position of the first wrong byte; the first is 1
  std::string what;        // a full clause
  std::string remedy;      // an imperative
};

// Reads "NAME = EXPRESSION" or "NAME [UNIT] = EXPRESSION".
// `targets`: names of the targets. `earlier`: channels that the expression may name.
// Fails: syntax, an unknown name, a product of two channels, a sum of different units without a stated unit, text
// beyond the limits.
[[nodiscard]] tl::expected<Channel, ChannelMistake> parse_channel(std::string_view text,
                                                                  std::span<const std::string> targets,
                                                                  std::span<const Channel> earlier);

// Reads an expression for the channel `name`. `unit`: stated unit; empty: that of the expression.
[[nodiscard]] tl::expected<Channel, ChannelMistake> parse_channel_value(const std::string& name,
                                                                        const std::string& unit, std::string_view text,
                                                                        std::span<const std::string> targets,
                                                                        std::span<const Channel> earlier);

// A target's name in an expression: bytes `first` to `first + count - 1`, with its quotes.
struct NamedTarget {
  std::size_t first = 0, count = 0;
  std::size_t target = 0;  // index in the list of targets
};

// Returns the names of targets in an expression, in their order. Fails like parse_channel_value.
[[nodiscard]] tl::expected<std::vector<NamedTarget>, ChannelMistake> targets_named_in(
    std::string_view text, std::span<const std::string> targets, std::span<const Channel> earlier);

// Returns the name in "NAME = EXPRESSION" or "NAME [UNIT] = EXPRESSION", without a check.
[[nodiscard]] std::string_view name_in_channel(std::string_view text);

// Returns what is wrong with a stated unit; empty: nothing.
[[nodiscard]] std::string channel_unit_problem(std::string_view unit);

// Returns what is wrong with a channel's name; empty: nothing. A name is a letter or underscore, then up to 63 letters,
// digits and underscores.
[[nodiscard]] std::string channel_name_problem(std::string_view name);

}  // namespace moiregauge::internal
