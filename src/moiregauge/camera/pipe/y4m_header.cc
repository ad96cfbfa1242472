// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/pipe/y4m_header.h"

#include <charconv>
#include <limits>
#include <optional>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr std::string_view kStreamMark = "YUV4MPEG2", kFrameMark = "FRAME";

// Chroma planes of a colour space: subsampling, number, and bits per sample.
struct Planes {
  int across = 1;  // luma pixels per chroma sample
  int down = 1;
  int chroma = 2;  // planes of the subsampled size
  int alpha = 0;   // planes of the full size
  int bits = 8;
};

template <typename Number>
std::optional<Number> whole_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// Reads "420jpeg", "422p10", "mono12", "444alpha" and others of the kind.
std::optional<Planes> planes_of(std::string_view name) {
  Planes planes;
  std::string_view rest;
  if (name.starts_with("mono")) {
    planes.chroma = 0;
    rest = name.substr(4);
    if (rest.empty()) return planes;
  } else {
    const std::string_view kind = name.substr(0, 3);
    if (kind == "420" || kind == "422")
      planes.across = 2;
    else if (kind == "411")
      planes.across = 4;
    else if (kind != "444")
      return std::nullopt;
    if (kind == "420") planes.down = 2;
    rest = name.substr(3);
    if (rest.empty() || rest == "jpeg" || rest == "mpeg2" || rest == "paldv") return planes;
    if (kind == "444" && rest == "alpha") {
      planes.alpha = 1;
      return planes;
    }
    if (rest[0] != 'p') return std::nullopt;
    rest.remove_prefix(1);
  }
  const auto bits = whole_number<int>(rest);
  if (!bits || *bits < 9 || *bits > 16) return std::nullopt;
  planes.bits = *bits;
  return planes;
}

double rate_of(std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto numerator = whole_number<int>(text.substr(0, colon));
  const auto denominator = colon == std::string_view::npos ? std::nullopt : whole_number<int>(text.substr(colon + 1));
  if (!numerator || !denominator || *numerator <= 0 || *denominator <= 0)
    return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(*numerator) / *denominator;
}

// Removes the first word, which ends at a space.
std::string_view take_word(std::string_view& text) {
  const std::size_t end = text.find(' ');
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return word;
}

constexpr std::size_t samples_across(int pixels, int per_sample) {
  return static_cast<std::size_t>((pixels + per_sample - 1) / per_sample);
}

void set_sizes(const Planes& planes, Y4mHeader& header) {
  const std::size_t word = planes.bits > 8 ? 2 : 1;
  const std::size_t luma = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height) * word;
  const std::size_t chroma =
      samples_across(header.width, planes.across) * samples_across(header.height, planes.down) * word;
  header.bits = planes.bits;
  header.luma_bytes = luma;
  header.frame_bytes =
      luma * static_cast<std::size_t>(1 + planes.alpha) + chroma * static_cast<std::size_t>(planes.chroma);
}

}  // namespace

tl::expected<Y4mHeader, std::string> read_y4m_header(std::string_view line, std::int64_t max_pixels) {
  if (take_word(line) != kStreamMark)
    return tl::unexpected(
        std::string("the input is no YUV4MPEG2 stream: write it with `ffmpeg ... -f yuv4mpegpipe -`"));
  Y4mHeader header;
  std::string_view colours = "420", range;
  header.fps = std::numeric_limits<double>::quiet_NaN();
  while (!line.empty()) {
    const std::string_view word = take_word(line);
    const std::string_view value = word.substr(word.empty() ? 0 : 1);
    switch (word.empty() ? ' ' : word[0]) {
      case 'W':
        header.width = whole_number<int>(value).value_or(0);
        break;
      case 'H':
        header.height = whole_number<int>(value).value_or(0);
        break;
      case 'F':
        header.fps = rate_of(value);
        break;
      case 'C':
        colours = value;
        break;
      case 'I':
        header.is_interlaced = value != "p" && value != "?";
        break;
      case 'X':
        if (value.starts_with("COLORRANGE=")) range = value.substr(11);
        break;
      default:
        break;  // aspect ratio, comments
    }
  }
  if (header.width <= 0 || header.height <= 0)
    return tl::unexpected(
        std::string("the YUV4MPEG2 stream states no frame size: write it with `ffmpeg ... -f yuv4mpegpipe -`"));
  if (header.width > max_pixels / header.height)
    return tl::unexpected(
        fmt::format("the frame size {}x{} exceeds the limit of {:g} Mpx: raise --max-pixels if the size is correct",
                    header.width, header.height, static_cast<double>(max_pixels) / 1e6));
  const auto planes = planes_of(colours);
  if (!planes)
    return tl::unexpected(fmt::format(
        "the YUV4MPEG2 stream has the unknown colour space '{}': write it with `-pix_fmt gray` or `-pix_fmt yuv420p`",
        colours.substr(0, 20)));
  set_sizes(*planes, header);
  // As for files (decoder/headers/stream_tone.cc): grey is linear and of full range, YUV is video.
  const bool is_grey = planes->chroma == 0, is_jpeg = colours == "420jpeg" && range == "FULL";
  if (!is_grey) header.tone.curve.kind = is_jpeg ? ToneCurve::Kind::kSrgb : ToneCurve::Kind::kBt709;
  header.tone.curve.is_full_range = is_grey || range == "FULL";
  return header;
}

bool is_y4m_frame_line(std::string_view line) {
  return line.starts_with(kFrameMark) && (line.size() == kFrameMark.size() || line[kFrameMark.size()] == ' ');
}

}  // namespace moiregauge::internal
