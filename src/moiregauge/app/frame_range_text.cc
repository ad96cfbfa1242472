// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/frame_range_text.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/base/duration_text.h"

namespace moiregauge::internal {
namespace {

bool parse_long(const std::string& text, long& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

bool has_unit(const std::string& part) { return part.find_last_not_of("0123456789+-.") != std::string::npos; }

// Reads both ends in seconds. Nothing: one of them is no time, or the range is empty.
std::optional<TimeRange> seconds_in(const std::string& first, const std::string& end) {
  TimeRange range;
  const auto read = [](const std::string& part, double& value) {
    if (part.empty() || part == "0") return true;
    const auto seconds = duration_s(part);
    if (seconds) value = *seconds;
    return seconds.has_value();
  };
  if (!read(first, range.first_s) || !read(end, range.end_s)) return std::nullopt;
  if (!(range.end_s > range.first_s)) return std::nullopt;
  return range;
}

bool read_frames(const std::string& first, const std::string& end, FrameRange& range) {
  if (!first.empty() && !parse_long(first, range.first)) return false;
  if (!end.empty() && !parse_long(end, range.end)) return false;
  return range.first >= 0 && (end.empty() || range.end > range.first);
}

}  // namespace

tl::expected<FrameRange, UsageError> frame_range_in(const std::string& text, const RangeOption& option) {
  const auto wrong = [&] {
    return usage(
        fmt::format("the frames cannot be read: {} {}: write frames A:B{}, half open, e.g. {}, or seconds, "
                    "e.g. 1.5s:3s",
                    option.name, text, option.has_step ? " or A:B:STEP" : "", option.example));
  };
  const std::vector<std::string> parts = parts_of(text);
  if (parts.size() < 2 || parts.size() > (option.has_step ? 3U : 2U)) return wrong();
  FrameRange range;
  if (has_unit(parts[0]) || has_unit(parts[1])) {
    range.seconds = seconds_in(parts[0], parts[1]);
    if (!range.seconds) return wrong();
  } else if (!read_frames(parts[0], parts[1], range)) {
    return wrong();
  }
  if (parts.size() == 3 && !parts[2].empty() && !parse_long(parts[2], range.step)) return wrong();
  if (range.step < 1) return wrong();
  return range;
}

tl::expected<FrameRange, UsageError> seconds_in_range(const std::string& text, const RangeOption& option) {
  std::vector<std::string> parts = parts_of(text);
  for (std::string& part : parts) {
    if (!part.empty() && !has_unit(part)) part += "s";
  }
  const auto range = parts.size() == 2 ? seconds_in(parts[0], parts[1]) : std::nullopt;
  if (!range)
    return usage(fmt::format("the time range cannot be read: {} {}: write seconds A:B, half open, e.g. {}", option.name,
                             text, option.example));
  return FrameRange{0, -1, 1, range};
}

}  // namespace moiregauge::internal
