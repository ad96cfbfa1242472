// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/png_file.h"

#include <cerrno>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <png.h>

namespace moiregauge::internal {
namespace {

struct PngWriter {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  PngWriter() = default;
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

// Packs a row. PNG stores the high byte of 16-bit samples first.
void pack(std::span<const std::uint8_t> row, std::vector<png_byte>& bytes) { bytes.assign(row.begin(), row.end()); }
void pack(std::span<const std::uint16_t> row, std::vector<png_byte>& bytes) {
  bytes.clear();
  for (const std::uint16_t grey : row) {
    bytes.push_back(static_cast<png_byte>(grey >> 8U));
    bytes.push_back(static_cast<png_byte>(grey & 0xffU));
  }
}

// Form of the stored grey levels.
struct PngSamples {
  int bits;  // significant ones
  PngTone tone;
};

// Returns false after an error of libpng, which leaves by longjmp. No object with a destructor may be created here.
template <typename Grey>
bool write_rows(PngWriter& writer, std::FILE* file, const ImageView<Grey>& view, PngSamples samples,
                std::vector<png_byte>& bytes) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_init_io(writer.png, file);
  png_set_compression_level(writer.png, 1);
  png_set_filter(writer.png, 0, PNG_FILTER_SUB);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(view.width), static_cast<png_uint_32>(view.height),
               8 * static_cast<int>(sizeof(Grey)), PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_color_8 significant{};
  significant.gray = static_cast<png_byte>(samples.bits);
  if (samples.bits != 8 * static_cast<int>(sizeof(Grey))) png_set_sBIT(writer.png, writer.info, &significant);
  if (samples.tone == PngTone::kLinear) png_set_gAMA(writer.png, writer.info, 1.0);
  png_write_info(writer.png, writer.info);
  for (int y = 0; y < view.height; ++y) {
    pack(view.row(y), bytes);
    png_write_row(writer.png, bytes.data());
  }
  png_write_end(writer.png, nullptr);
  return true;
}

}  // namespace

tl::expected<void, std::string> write_png(const std::string& path, const LumaView& picture, int bits, PngTone tone) {
  const std::string unfinished = path + ".part";
  const auto failed = [&] {
    const std::string why = std::strerror(errno);
    std::remove(unfinished.c_str());
    return tl::unexpected(fmt::format("{}: {}", path, why));
  };
  std::FILE* file = std::fopen(unfinished.c_str(), "wb");
  if (file == nullptr) return failed();
  PngWriter writer;
  std::vector<png_byte> bytes;
  const bool wrote = writer.info != nullptr && std::visit(
                                                   [&](const auto& view) {
                                                     return write_rows(writer, file, view, {bits, tone}, bytes);
                                                   },
                                                   picture);
  const bool closed = std::fclose(file) == 0;
  if (!wrote || !closed || std::rename(unfinished.c_str(), path.c_str()) != 0) return failed();
  return {};
}

}  // namespace moiregauge::internal
