// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/genicam/raw_pixels.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "moiregauge/image/luma_of_colour.h"

namespace moiregauge::internal {
namespace {

static_assert(std::endian::native == std::endian::little, "cameras send little-endian words");

struct Known {
  std::uint32_t pfnc;
  RawLayout layout;
};

// Numbers: PFNC 2.1 and GigE Vision 2.0.
constexpr Known kKnown[] = {
    {0x01080001, {"Mono8", Packing::kWhole, 8}},
    {0x01100003, {"Mono10", Packing::kWhole, 10}},
    {0x01100005, {"Mono12", Packing::kWhole, 12}},
    {0x01100025, {"Mono14", Packing::kWhole, 14}},
    {0x01100007, {"Mono16", Packing::kWhole, 16}},
    {0x010c0004, {"Mono10Packed", Packing::kNibbles, 10}},
    {0x010c0006, {"Mono12Packed", Packing::kNibbles, 12}},
    {0x010a0046, {"Mono10p", Packing::kBitStream, 10}},
    {0x010c0047, {"Mono12p", Packing::kBitStream, 12}},
    {0x01080008, {"BayerGR8", Packing::kWhole, 8, 1, 0}},
    {0x01080009, {"BayerRG8", Packing::kWhole, 8, 0, 0}},
    {0x0108000a, {"BayerGB8", Packing::kWhole, 8, 0, 1}},
    {0x0108000b, {"BayerBG8", Packing::kWhole, 8, 1, 1}},
    {0x0110000c, {"BayerGR10", Packing::kWhole, 10, 1, 0}},
    {0x0110000d, {"BayerRG10", Packing::kWhole, 10, 0, 0}},
    {0x0110000e, {"BayerGB10", Packing::kWhole, 10, 0, 1}},
    {0x0110000f, {"BayerBG10", Packing::kWhole, 10, 1, 1}},
    {0x01100010, {"BayerGR12", Packing::kWhole, 12, 1, 0}},
    {0x01100011, {"BayerRG12", Packing::kWhole, 12, 0, 0}},
    {0x01100012, {"BayerGB12", Packing::kWhole, 12, 0, 1}},
    {0x01100013, {"BayerBG12", Packing::kWhole, 12, 1, 1}},
    {0x0110002e, {"BayerGR16", Packing::kWhole, 16, 1, 0}},
    {0x0110002f, {"BayerRG16", Packing::kWhole, 16, 0, 0}},
    {0x01100030, {"BayerGB16", Packing::kWhole, 16, 0, 1}},
    {0x01100031, {"BayerBG16", Packing::kWhole, 16, 1, 1}},
    {0x010c0026, {"BayerGR10Packed", Packing::kNibbles, 10, 1, 0}},
    {0x010c0027, {"BayerRG10Packed", Packing::kNibbles, 10, 0, 0}},
    {0x010c0028, {"BayerGB10Packed", Packing::kNibbles, 10, 0, 1}},
    {0x010c0029, {"BayerBG10Packed", Packing::kNibbles, 10, 1, 1}},
    {0x010c002a, {"BayerGR12Packed", Packing::kNibbles, 12, 1, 0}},
    {0x010c002b, {"BayerRG12Packed", Packing::kNibbles, 12, 0, 0}},
    {0x010c002c, {"BayerGB12Packed", Packing::kNibbles, 12, 0, 1}},
    {0x010c002d, {"BayerBG12Packed", Packing::kNibbles, 12, 1, 1}},
    {0x010a0056, {"BayerGR10p", Packing::kBitStream, 10, 1, 0}},
    {0x010a0058, {"BayerRG10p", Packing::kBitStream, 10, 0, 0}},
    {0x010a0054, {"BayerGB10p", Packing::kBitStream, 10, 0, 1}},
    {0x010a0052, {"BayerBG10p", Packing::kBitStream, 10, 1, 1}},
    {0x010c0057, {"BayerGR12p", Packing::kBitStream, 12, 1, 0}},
    {0x010c0059, {"BayerRG12p", Packing::kBitStream, 12, 0, 0}},
    {0x010c0055, {"BayerGB12p", Packing::kBitStream, 12, 0, 1}},
    {0x010c0053, {"BayerBG12p", Packing::kBitStream, 12, 1, 1}},
    {0x02180014, {"RGB8", Packing::kRgb, 8}},
    {0x02180015, {"BGR8", Packing::kBgr, 8}},
};

std::size_t count_of(const RawPixels& raw) {
  return static_cast<std::size_t>(raw.width) * static_cast<std::size_t>(raw.height);
}

// Returns the bytes that the pixels occupy, or 0 if rows are padded inside a packed stream, which no camera does.
std::size_t bytes_needed(const RawLayout& layout, const RawPixels& raw) {
  const auto rows = static_cast<std::size_t>(raw.height), padding = static_cast<std::size_t>(raw.padding_bytes);
  switch (layout.packing) {
    case Packing::kWhole:
      return count_of(raw) * (layout.bits > 8 ? 2 : 1) + rows * padding;
    case Packing::kRgb:
    case Packing::kBgr:
      return count_of(raw) * 3 + rows * padding;
    case Packing::kNibbles:
      return padding == 0 ? (count_of(raw) * 3 + 1) / 2 : 0;
    case Packing::kBitStream:
      return padding == 0 ? (count_of(raw) * static_cast<std::size_t>(layout.bits) + 7) / 8 : 0;
  }
  return 0;
}

void unpack_nibbles(std::span<const std::uint8_t> in, int bits, std::span<std::uint16_t> out) {
  const unsigned low_bits = static_cast<unsigned>(bits) - 8U, mask = (1U << low_bits) - 1U;
  for (std::size_t pixel = 0; pixel < out.size(); ++pixel) {
    const std::uint8_t* pair = in.data() + pixel / 2 * 3;
    const bool is_second = pixel % 2 == 1;
    const unsigned high = is_second ? pair[2] : pair[0];
    const unsigned low = (is_second ? pair[1] >> 4U : pair[1]) & mask;
    out[pixel] = static_cast<std::uint16_t>(high << low_bits | low);
  }
}

void unpack_bit_stream(std::span<const std::uint8_t> in, int bits, std::span<std::uint16_t> out) {
  std::uint32_t waiting = 0;
  int waiting_bits = 0;
  std::size_t next = 0;
  for (std::uint16_t& grey : out) {
    for (; waiting_bits < bits; waiting_bits += 8) waiting |= std::uint32_t{in[next++]} << waiting_bits;
    grey = static_cast<std::uint16_t>(waiting & ((1U << bits) - 1U));
    waiting >>= bits;
    waiting_bits -= bits;
  }
}

}  // namespace

std::optional<RawLayout> raw_layout(std::uint32_t pfnc) {
  const auto* found =
      std::find_if(std::begin(kKnown), std::end(kKnown), [&](const Known& known) { return known.pfnc == pfnc; });
  return found == std::end(kKnown) ? std::nullopt : std::optional(found->layout);
}

// Borrows the received bytes where they are a plane already.
LumaView RawToLuma::whole(const RawPixels& raw) {
  if (layout_.bits == 8) {
    return ImageView<std::uint8_t>{raw.bytes.data(), raw.width, raw.height,
                                   std::ptrdiff_t{raw.width} + raw.padding_bytes};
  }
  const bool is_aligned = reinterpret_cast<std::uintptr_t>(raw.bytes.data()) % alignof(std::uint16_t) == 0;
  if (is_aligned && raw.padding_bytes % 2 == 0) {
    return ImageView<std::uint16_t>{reinterpret_cast<const std::uint16_t*>(raw.bytes.data()), raw.width, raw.height,
                                    std::ptrdiff_t{raw.width} + raw.padding_bytes / 2};
  }
  words_.resize(count_of(raw));
  const std::size_t row_bytes = 2 * static_cast<std::size_t>(raw.width);
  for (int y = 0; y < raw.height; ++y) {
    const auto row = static_cast<std::size_t>(y);
    std::memcpy(words_.data() + row * static_cast<std::size_t>(raw.width),
                raw.bytes.data() + row * (row_bytes + static_cast<std::size_t>(raw.padding_bytes)), row_bytes);
  }
  return ImageView<std::uint16_t>{words_.data(), raw.width, raw.height, raw.width};
}

void RawToLuma::unpack(const RawPixels& raw) {
  words_.resize(count_of(raw));
  if (layout_.packing == Packing::kNibbles)
    unpack_nibbles(raw.bytes, layout_.bits, words_);
  else
    unpack_bit_stream(raw.bytes, layout_.bits, words_);
}

void RawToLuma::mix_colours(const RawPixels& raw) {
  bytes_.resize(count_of(raw));
  const std::size_t red = layout_.packing == Packing::kRgb ? 0 : 2;
  std::uint8_t* out = bytes_.data();
  const std::uint8_t* in = raw.bytes.data();
  for (int y = 0; y < raw.height; ++y, in += raw.padding_bytes) {
    for (int x = 0; x < raw.width; ++x, in += 3) *out++ = luma_of_colour<std::uint8_t>(in[red], in[1], in[2 - red]);
  }
}

template <typename Grey>
ImageView<Grey> RawToLuma::cells(ImageView<Grey> sites, std::vector<Grey>& out) const {
  const int width = sites.width / 2, height = sites.height / 2;
  out.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  auto* to = out.data();
  for (int y = 0; y < height; ++y) {
    const auto* red_row = sites.data + (2 * y + layout_.red_y) * sites.stride;
    const auto* blue_row = sites.data + (2 * y + 1 - layout_.red_y) * sites.stride;
    for (int x = 0; x < width; ++x) {
      const int red_x = 2 * x + layout_.red_x, blue_x = 2 * x + 1 - layout_.red_x;
      const auto green = static_cast<Grey>((std::uint32_t{red_row[blue_x]} + blue_row[red_x] + 1U) / 2U);
      *to++ = mosaic_ == MosaicGrey::kGreen ? green : luma_of_colour<Grey>(red_row[red_x], green, blue_row[blue_x]);
    }
  }
  return {out.data(), width, height, width};
}

tl::expected<LumaView, std::string> RawToLuma::luma(const RawPixels& raw) {
  const std::size_t needed = raw.width > 0 && raw.height > 0 && raw.padding_bytes >= 0 ? bytes_needed(layout_, raw) : 0;
  if (needed == 0)
    return tl::unexpected(
        fmt::format("the camera's rows of {} pixels are padded by {} bytes", raw.width, raw.padding_bytes));
  if (raw.bytes.size() < needed)
    return tl::unexpected(fmt::format("a frame has {} bytes instead of {}", raw.bytes.size(), needed));
  LumaView sites;
  if (layout_.packing == Packing::kWhole) {
    sites = whole(raw);
  } else if (layout_.packing == Packing::kRgb || layout_.packing == Packing::kBgr) {
    mix_colours(raw);
    sites = ImageView<std::uint8_t>{bytes_.data(), raw.width, raw.height, raw.width};
  } else {
    unpack(raw);
    sites = ImageView<std::uint16_t>{words_.data(), raw.width, raw.height, raw.width};
  }
  if (!layout_.is_mosaic()) return sites;
  if (const auto* bytes = std::get_if<ImageView<std::uint8_t>>(&sites)) return cells(*bytes, byte_cells_);
  return cells(std::get<ImageView<std::uint16_t>>(sites), word_cells_);
}

}  // namespace moiregauge::internal
