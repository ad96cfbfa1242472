// SPDX-License-Identifier: Apache-2.0
// Reads AVI files with one stream of uncompressed video. RIFF chunks have a name, a length and that number of bytes
// (OpenDML files contain several RIFFs). Frames follow one another, so the index is not needed.
#include <algorithm>
#include <numeric>

#include "moiregauge/decoder/stored/stored_video.h"

namespace moiregauge::internal {
namespace {

using Bytes = std::span<const std::byte>;

std::uint32_t u32_at(Bytes bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8U | std::to_integer<std::uint32_t>(bytes[at + k]);
  return value;
}

constexpr std::uint32_t name(const char (&text)[5]) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8U | static_cast<std::uint8_t>(text[k]);
  return value;
}

struct Chunk {
  std::uint32_t name = 0;
  std::uint32_t list = 0;  // RIFF and LIST: their content type
  std::size_t begin = 0;   // offset of its bytes, after the list's name
  std::size_t size = 0;
  std::size_t next = 0;
};

// Returns nothing if the chunk is incomplete.
std::optional<Chunk> chunk_at(Bytes file, std::size_t at, std::size_t end) {
  if (end - at < 8) return std::nullopt;
  Chunk chunk{u32_at(file, at), 0, at + 8, u32_at(file, at + 4), 0};
  if (chunk.size > end - chunk.begin) return std::nullopt;
  chunk.next = std::min(end, chunk.begin + chunk.size + chunk.size % 2);
  if (chunk.name != name("RIFF") && chunk.name != name("LIST")) return chunk;
  if (chunk.size < 4) return std::nullopt;
  chunk.list = u32_at(file, chunk.begin);
  chunk.begin += 4;
  chunk.size -= 4;
  return chunk;
}

class Avi {
 public:
  explicit Avi(Bytes file) : file_(file) {}

  std::optional<StoredVideo> read() {
    std::uint32_t expected = name("AVI ");
    for (std::size_t at = 0; at < file_.size();) {
      const auto riff = chunk_at(file_, at, file_.size());
      if (!riff || riff->name != name("RIFF") || riff->list != expected) return std::nullopt;
      if (!each_in(*riff, [this](const Chunk& chunk) { return in_riff(chunk); })) return std::nullopt;
      expected = name("AVIX");
      at = riff->next;
    }
    if (video_.frames.size() != promised_ || !is_usable(video_)) return std::nullopt;
    return std::move(video_);
  }

 private:
  template <typename Visit>
  bool each_in(const Chunk& list, Visit visit) {
    const std::size_t end = list.begin + list.size;
    for (std::size_t at = list.begin; at < end;) {
      const auto chunk = chunk_at(file_, at, end);
      if (!chunk || !visit(*chunk)) return false;
      at = chunk->next;
    }
    return true;
  }

  bool in_riff(const Chunk& chunk) {
    if (chunk.list == name("hdrl")) return each_in(chunk, [this](const Chunk& c) { return in_head(c); });
    if (chunk.list == name("movi"))
      return has_format_ && each_in(chunk, [this](const Chunk& c) { return in_movie(c); });
    return chunk.list == name("INFO") || chunk.name == name("JUNK") || chunk.name == name("idx1");
  }

  bool in_head(const Chunk& chunk) {
    if (chunk.list != name("strl")) return true;
    if (++streams_ > 1) return false;
    return each_in(chunk, [this](const Chunk& c) { return in_stream(c); }) && has_format_ && promised_ > 0;
  }

  bool in_stream(const Chunk& chunk) {
    if (chunk.name == name("strh")) {
      if (chunk.size < 48 || u32_at(file_, chunk.begin) != name("vids")) return false;
      const std::int64_t scale = u32_at(file_, chunk.begin + 20), rate = u32_at(file_, chunk.begin + 24);
      const std::uint32_t start = u32_at(file_, chunk.begin + 28);
      promised_ = u32_at(file_, chunk.begin + 32);
      if (scale <= 0 || rate <= 0 || start != 0) return false;
      const std::int64_t common = std::gcd(scale, rate);
      video_.tick_numerator = scale / common;
      video_.tick_denominator = rate / common;
    } else if (chunk.name == name("strf")) {
      if (has_format_ || chunk.size != 40) return false;
      video_.width = static_cast<std::int32_t>(u32_at(file_, chunk.begin + 4));
      video_.height = static_cast<std::int32_t>(u32_at(file_, chunk.begin + 8));
      fourcc_ = u32_at(file_, chunk.begin + 16);
      has_format_ = true;
    }
    return true;  // names, aspects, indexes
  }

  bool in_movie(const Chunk& chunk) {
    if (chunk.name == name("JUNK") || chunk.name == name("ix00")) return true;
    if (chunk.name != name("00dc") && chunk.name != name("00db")) return false;
    const auto pixels = stored_pixels(fourcc_, video_.width, video_.height, chunk.size, RowGroups::kFourBytes);
    if (!pixels || (!video_.frames.empty() && pixels->row_bytes != video_.row_bytes)) return false;
    video_.bits = pixels->bits;
    video_.row_bytes = pixels->row_bytes;
    video_.ticks.push_back(static_cast<std::int64_t>(video_.frames.size()));
    video_.frames.push_back(chunk.begin);
    return true;
  }

  Bytes file_;
  StoredVideo video_;
  std::uint32_t fourcc_ = 0;
  std::size_t promised_ = 0;  // number of frames by the stream header
  int streams_ = 0;
  bool has_format_ = false;
};

}  // namespace

std::optional<StoredVideo> stored_avi(std::span<const std::byte> file) { return Avi(file).read(); }

}  // namespace moiregauge::internal
