// SPDX-License-Identifier: Apache-2.0
// Reads Matroska files with one track of uncompressed video. EBML elements have an id, a length and that number of
// bytes.
#include <string_view>

#include "moiregauge/decoder/stored/stored_video.h"

namespace moiregauge::internal {
namespace {

using Bytes = std::span<const std::byte>;

namespace id {
constexpr std::uint64_t kHead = 0x1A45DFA3, kSegment = 0x18538067, kInfo = 0x1549A966, kTracks = 0x1654AE6B,
                        kCluster = 0x1F43B675, kTimestampScale = 0x2AD7B1, kTrack = 0xAE, kTrackNumber = 0xD7,
                        kTrackType = 0x83, kCodec = 0x86, kVideo = 0xE0, kWidth = 0xB0, kHeight = 0xBA,
                        kInterlaced = 0x9A, kColourSpace = 0x2EB524, kClusterTime = 0xE7, kSimpleBlock = 0xA3,
                        kBlockGroup = 0xA0, kBlock = 0xA1;
// Elements that change the meaning of images or times: compressed blocks, other clocks, discarded parts, projections,
// operations.
constexpr std::uint64_t kNotUnderstood[] = {0x6D80, 0x23314F, 0x537F, 0x56AA, 0x75A2, 0x7670, 0xE2, 0x75A1};
}  // namespace id

struct Element {
  std::uint64_t id = 0;
  std::size_t begin = 0;  // offset of its bytes
  std::size_t size = 0;
  [[nodiscard]] std::size_t end() const { return begin + size; }
};

// A number of 1 to 8 bytes. The leading zeros of the first byte give its length.
struct Vint {
  std::uint64_t value = 0;
  std::size_t bytes = 0;
  bool unknown = false;  // all ones: a length unknown when it was written
};

std::optional<Vint> vint_at(Bytes file, std::size_t at, std::size_t end, bool keep_marker) {
  if (at >= end) return std::nullopt;
  const auto first = std::to_integer<unsigned>(file[at]);
  std::size_t bytes = 1;
  while (bytes <= 8 && (first & (0x80U >> (bytes - 1))) == 0) ++bytes;
  if (bytes > 8 || bytes > end - at) return std::nullopt;
  const unsigned mask = 0xffU >> bytes;
  std::uint64_t value = keep_marker ? first : first & mask;
  for (std::size_t k = 1; k < bytes; ++k) value = value << 8U | std::to_integer<std::uint64_t>(file[at + k]);
  return Vint{value, bytes, !keep_marker && value == (std::uint64_t{1} << (7 * bytes)) - 1};
}

std::optional<Element> element_at(Bytes file, std::size_t at, std::size_t end) {
  const auto name = vint_at(file, at, end, true);
  if (!name || name->bytes > 4) return std::nullopt;
  const auto length = vint_at(file, at + name->bytes, end, false);
  if (!length || length->unknown) return std::nullopt;
  const std::size_t begin = at + name->bytes + length->bytes;
  if (length->value > end - begin) return std::nullopt;
  return Element{name->value, begin, static_cast<std::size_t>(length->value)};
}

class Matroska {
 public:
  explicit Matroska(Bytes file) : file_(file) {}

  std::optional<StoredVideo> read() {
    const auto head = element_at(file_, 0, file_.size());
    if (!head || head->id != id::kHead) return std::nullopt;
    const auto segment = element_at(file_, head->end(), file_.size());
    if (!segment || segment->id != id::kSegment || segment->end() != file_.size()) return std::nullopt;
    if (!each_in(*segment, [this](const Element& e) { return in_segment(e); })) return std::nullopt;
    video_.tick_numerator = 1;
    video_.tick_denominator = 1000;
    if (!is_usable(video_)) return std::nullopt;
    return std::move(video_);
  }

 private:
  template <typename Visit>
  bool each_in(const Element& parent, Visit visit) {
    for (std::size_t at = parent.begin; at < parent.end();) {
      const auto element = element_at(file_, at, parent.end());
      if (!element) return false;
      for (const std::uint64_t strange : id::kNotUnderstood) {
        if (element->id == strange) return false;
      }
      if (!visit(*element)) return false;
      at = element->end();
    }
    return true;
  }

  [[nodiscard]] std::uint64_t number_in(const Element& element) const {
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < element.size; ++k)
      value = value << 8U | std::to_integer<std::uint64_t>(file_[element.begin + k]);
    return element.size <= 8 ? value : 0;
  }
  [[nodiscard]] std::string_view text_in(const Element& element) const {
    return {reinterpret_cast<const char*>(file_.data()) + element.begin, element.size};
  }

  bool in_segment(const Element& e) {
    if (e.id == id::kInfo)
      return each_in(e, [this](const Element& c) { return c.id != id::kTimestampScale || number_in(c) == 1'000'000; });
    if (e.id == id::kTracks) return each_in(e, [this](const Element& c) { return c.id != id::kTrack || in_track(c); });
    if (e.id != id::kCluster) return true;  // indexes, tags
    cluster_time_.reset();
    return track_ > 0 && each_in(e, [this](const Element& c) { return in_cluster(c); });
  }

  bool in_track(const Element& track) {
    if (++tracks_ > 1) return false;
    return each_in(track, [this](const Element& e) {
      if (e.id == id::kTrackNumber) track_ = number_in(e);
      if (e.id == id::kTrackType) return number_in(e) == 1;
      if (e.id == id::kCodec) return text_in(e) == "V_UNCOMPRESSED";
      return e.id != id::kVideo || each_in(e, [this](const Element& c) { return in_video(c); });
    });
  }

  bool in_video(const Element& e) {
    if (e.id == id::kInterlaced) return number_in(e) != 1;
    const std::uint64_t number = number_in(e);
    if (e.id == id::kWidth || e.id == id::kHeight) {
      if (number == 0 || number > 1U << 28U) return false;
      (e.id == id::kWidth ? video_.width : video_.height) = static_cast<int>(number);
    } else if (e.id == id::kColourSpace) {
      if (e.size != 4) return false;
      for (std::size_t k = 4; k-- > 0;) fourcc_ = fourcc_ << 8U | std::to_integer<std::uint32_t>(file_[e.begin + k]);
    }
    return true;
  }

  bool in_cluster(const Element& e) {
    if (e.id == id::kClusterTime) {
      cluster_time_ = number_in(e);
      return *cluster_time_ < std::uint64_t{1} << 62U;
    }
    if (e.id == id::kSimpleBlock) return add_block(e);
    return e.id != id::kBlockGroup ||
           each_in(e, [this](const Element& c) { return c.id != id::kBlock || add_block(c); });
  }

  bool add_block(const Element& block) {
    const auto track = vint_at(file_, block.begin, block.end(), false);
    if (!track || track->value != track_ || block.size < track->bytes + 3 || !cluster_time_) return false;
    const std::size_t at = block.begin + track->bytes;
    const auto byte = [&](std::size_t k) { return std::to_integer<unsigned>(file_[at + k]); };
    if ((byte(2) & 0x06U) != 0) return false;  // several frames in one block
    const std::size_t begin = at + 3;
    const auto pixels = stored_pixels(fourcc_, video_.width, video_.height, block.end() - begin, RowGroups::kPacked);
    if (!pixels) return false;
    video_.bits = pixels->bits;
    video_.row_bytes = pixels->row_bytes;
    const auto later = static_cast<std::int16_t>(static_cast<std::uint16_t>(byte(0) << 8U | byte(1)));
    video_.ticks.push_back(static_cast<std::int64_t>(*cluster_time_) + later);
    video_.frames.push_back(begin);
    return true;
  }

  Bytes file_;
  StoredVideo video_;
  std::uint64_t track_ = 0;
  int tracks_ = 0;
  std::uint32_t fourcc_ = 0;
  std::optional<std::uint64_t> cluster_time_;
};

}  // namespace

std::optional<StoredVideo> stored_matroska(std::span<const std::byte> file) { return Matroska(file).read(); }

}  // namespace moiregauge::internal
