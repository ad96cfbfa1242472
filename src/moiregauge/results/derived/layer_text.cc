// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "moiregauge/results/derived/layers.h"

namespace moiregauge::internal {
namespace {

constexpr int kMaxMedian = 999;  // rows; chosen

// Reads "5Hz", "0.2 Hz" or "1kHz". Nothing: no unit, not finite, or not above zero.
std::optional<double> frequency_in(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  std::string_view unit = text.substr(static_cast<std::size_t>(end - text.data()));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  if (unit != "Hz" && unit != "kHz") return std::nullopt;
  value *= unit == "kHz" ? 1e3 : 1.0;
  return std::isfinite(value) && value > 0.0 ? std::optional(value) : std::nullopt;
}

tl::expected<FilterLayer, std::string> filter_in(std::string_view value) {
  const auto colon = value.find(':');
  const std::string_view kind = value.substr(0, colon);
  const std::string_view at = colon == std::string_view::npos ? std::string_view() : value.substr(colon + 1);
  FilterLayer filter;
  if (kind == "bandpass") {
    const auto dash = at.find('-');
    const auto low = frequency_in(at.substr(0, dash));
    const auto high = dash == std::string_view::npos ? std::nullopt : frequency_in(at.substr(dash + 1));
    if (low && high && *low < *high) return FilterLayer{*low, *high};
  } else if (const auto f = frequency_in(at); f && kind == "lowpass") {
    return FilterLayer{0.0, *f};
  } else if (f && kind == "highpass") {
    return FilterLayer{*f, 0.0};
  }
  return tl::unexpected(std::string("write lowpass:5Hz, highpass:0.2Hz or bandpass:1Hz-5Hz"));
}

std::optional<int> odd_number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc{} && end == text.data() + text.size();
  return is_number && value >= 3 && value <= kMaxMedian && value % 2 == 1 ? std::optional(value) : std::nullopt;
}

}  // namespace

tl::expected<Layer, std::string> parse_layer(std::string_view option, std::string_view value) {
  Layer layer{DetrendLayer{}, fmt::format("{} {}", option, value)};
  if (option == "filter") {
    const auto filter = filter_in(value);
    if (!filter) return tl::unexpected(filter.error());
    layer.what = *filter;
    return layer;
  }
  if (option == "median") {
    const auto rows = odd_number(value);
    if (!rows) return tl::unexpected(fmt::format("write an odd number of rows from 3 to {}", kMaxMedian));
    layer.what = MedianLayer{*rows};
    return layer;
  }
  const auto hz = frequency_in(value);
  if (!hz) return tl::unexpected(std::string("write a frequency with its unit, e.g. 5Hz"));
  if (option == "velocity")
    layer.what = VelocityLayer{*hz};
  else
    layer.what = ResampleLayer{*hz};
  return layer;
}

}  // namespace moiregauge::internal
