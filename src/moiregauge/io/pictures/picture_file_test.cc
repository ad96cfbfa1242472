// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/picture_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <jpeglib.h>
#include <tiffio.h>

#include "moiregauge/io/pictures/exif_orientation.h"
#include "moiregauge/io/pictures/picture_source.h"
#include "moiregauge/io/pictures/pictures_for_tests.h"
#include "moiregauge/io/pictures/tiff_reader.h"

namespace moiregauge::internal {
namespace {

// Writes pages of 3 x 2 px. Every sample of page p is first + p.
void write_tiff(const std::string& path, int pages, int bits, int samples, unsigned first, int orientation = 1) {
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  for (int page = 0; page < pages; ++page) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 3);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 2);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, samples);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, samples == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, orientation);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
    for (unsigned y = 0; y < 2; ++y) {
      std::vector<std::uint8_t> bytes(static_cast<std::size_t>(3 * samples),
                                      static_cast<std::uint8_t>(first + static_cast<unsigned>(page)));
      std::vector<std::uint16_t> words(static_cast<std::size_t>(3 * samples),
                                       static_cast<std::uint16_t>(first + static_cast<unsigned>(page)));
      void* row = bits == 8 ? static_cast<void*>(bytes.data()) : static_cast<void*>(words.data());
      TIFFWriteScanline(tiff, row, y, 0);
    }
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
}

// Writes a JPEG of 16 x 8 px, left half dark and right half bright, with an Exif block if given.
void write_jpeg(const std::string& path, const std::string& exif) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  jpeg_stdio_dest(&jpeg, file);
  jpeg.image_width = 16;
  jpeg.image_height = 8;
  jpeg.input_components = 1;
  jpeg.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  if (!exif.empty()) {
    jpeg_write_marker(&jpeg, JPEG_APP0 + 1, reinterpret_cast<const JOCTET*>(exif.data()),
                      static_cast<unsigned>(exif.size()));
  }
  std::vector<JSAMPLE> row(16, 40);
  std::fill(row.begin() + 8, row.end(), JSAMPLE{200});
  JSAMPROW rows = row.data();
  while (jpeg.next_scanline < 8) jpeg_write_scanlines(&jpeg, &rows, 1);
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::fclose(file);
}

std::string exif_of(int orientation) {
  std::string text("Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\0\0\0\0\0\0\0", 32);
  text[25] = static_cast<char>(orientation);
  return text;
}

TEST(TiffStack, EveryPageIsAFrameAtItsDepth) {
  const TestFolder folder;
  for (const int bits : {8, 16}) {
    write_tiff(folder / "a.tif", 3, bits, 1, 200);
    auto source = open_pictures(folder / "a.tif", {}).value();
    EXPECT_EQ(source->info().frames, 3);
    EXPECT_EQ(source->info().bits, bits);
    EXPECT_EQ(source->info().codec, "tiff");
    for (unsigned page = 0; page < 3; ++page) {
      const auto frame = source->next().value();
      EXPECT_EQ(std::visit([](auto view) { return unsigned{view.at(2, 1)}; }, frame->luma), 200 + page);
      EXPECT_FALSE(frame->damaged);
    }
    EXPECT_FALSE(source->next().value().has_value());
  }
}

TEST(TiffStack, ColourAndOrientationAreRead) {
  const TestFolder folder;
  write_tiff(folder / "c.tif", 1, 16, 3, 4000, 6);
  const Picture picture = read_picture(folder / "c.tif").value();
  EXPECT_EQ(picture.rotation_deg, 90);
  EXPECT_EQ(width_of(view_of(picture)), 2);
  EXPECT_EQ(std::get<1>(picture.grey).at(0, 0), 4000);
  write_tiff(folder / "m.tif", 1, 8, 1, 1, 2);
  EXPECT_EQ(read_picture(folder / "m.tif").error().kind, InputErrorKind::kUnsupported) << "mirrored";
}

TEST(TiffStack, MoreSamplesThanColourAndTransparencyAreRefused) {
  const TestFolder folder;
  write_tiff(folder / "four.tif", 1, 8, 4, 7);
  EXPECT_TRUE(read_picture(folder / "four.tif"));
  write_tiff(folder / "five.tif", 1, 8, 5, 7);
  const auto five = read_picture(folder / "five.tif");
  ASSERT_FALSE(five);
  EXPECT_EQ(five.error().kind, InputErrorKind::kUnsupported);
}

// Writes uncompressed pages of 40 x 30 px. Every sample depends on page and position.
void write_plain_tiff(const std::string& path, const char* mode, int pages, int bits, int rows_per_strip) {
  TIFF* tiff = TIFFOpen(path.c_str(), mode);
  for (int page = 0; page < pages; ++page) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 40);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 30);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, rows_per_strip);
    for (unsigned y = 0; y < 30; ++y) {
      std::array<std::uint16_t, 40> words{};
      std::array<std::uint8_t, 40> bytes{};
      for (unsigned x = 0; x < 40; ++x)
        bytes[x] = static_cast<std::uint8_t>(words[x] = static_cast<std::uint16_t>(x + 5 * y + 7U * unsigned(page)));
      TIFFWriteScanline(tiff, bits == 8 ? static_cast<void*>(bytes.data()) : static_cast<void*>(words.data()), y, 0);
    }
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
}

void expect_plain_page(const Picture& picture, unsigned page) {
  std::visit(
      [page](const auto& view) {
        ASSERT_EQ(view.width, 40);
        ASSERT_EQ(view.height, 30);
        for (int y = 0; y < 30; ++y) {
          for (int x = 0; x < 40; ++x)
            ASSERT_EQ(unsigned{view.at(x, y)}, unsigned(x) + 5U * unsigned(y) + 7U * page) << x << "," << y;
        }
      },
      view_of(picture));
}

TEST(TiffStack, UncompressedPagesAreReadInPlace) {
  const TestFolder folder;
  for (const int bits : {8, 16}) {
    for (const char* mode : {"w", "w8"}) {
      for (const int rows : {1, 7, 30}) {
        write_plain_tiff(folder / "a.tif", mode, 3, bits, rows);
        const auto stack = TiffStack::open(folder / "a.tif").value();
        for (unsigned page = 0; page < 3; ++page) {
          const Picture picture = stack->read(page).value();
          EXPECT_TRUE(picture.in_place) << bits << mode << rows;
          EXPECT_EQ(picture.bits, bits);
          expect_plain_page(picture, page);
        }
      }
    }
  }
}

TEST(TiffStack, WordsOfAnotherByteOrderGiveTheSameLevels) {
  const TestFolder folder;
  write_plain_tiff(folder / "a.tif", "wb", 2, 16, 30);
  const Picture words = TiffStack::open(folder / "a.tif").value()->read(1).value();
  EXPECT_FALSE(words.in_place);
  expect_plain_page(words, 1);
}

TEST(TiffStack, AnImageInPlaceOutlivesItsStack) {
  const TestFolder folder;
  write_plain_tiff(folder / "a.tif", "w", 1, 8, 30);
  const Picture picture = read_picture(folder / "a.tif").value();
  EXPECT_TRUE(picture.in_place);
  expect_plain_page(picture, 0);
}

TEST(TiffStack, AFileTruncatedWhileReadEndsTheInput) {
  const TestFolder folder;
  write_plain_tiff(folder / "a.tif", "w", 20, 16, 30);
  auto source = open_pictures(folder / "a.tif", {}).value();
  EXPECT_FALSE(source->next().value()->damaged);
  std::filesystem::resize_file(folder / "a.tif", 3000);
  const auto cut = source->next();
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().kind, InputErrorKind::kDamaged);
  EXPECT_NE(cut.error().message.find("became shorter during the measurement: "), std::string::npos)
      << cut.error().message;
  EXPECT_FALSE(source->next()) << "an error stays";
}

TEST(TiffStack, AnUncompressedTruncatedFileIsDamagedWithoutACrash) {
  const TestFolder folder;
  write_plain_tiff(folder / "a.tif", "w", 3, 8, 7);
  const std::string whole = text_of(folder / "a.tif");
  for (std::size_t size = 8; size < whole.size(); size += 13) {
    put_text(folder / "cut.tif", whole.substr(0, size));
    auto source = open_pictures(folder / "cut.tif", {});
    for (int i = 0; source && i < 4; ++i) {
      const auto frame = (*source)->next();
      if (!frame || !*frame) break;
      EXPECT_EQ(width_of((*frame)->luma), 40);
      EXPECT_GE(std::visit([](const auto& view) { return unsigned{view.at(39, 29)}; }, (*frame)->luma), 0U);
    }
  }
}

TEST(TiffStack, ATruncatedFileIsDamagedWithoutACrash) {
  const TestFolder folder;
  write_tiff(folder / "a.tif", 5, 8, 1, 1);
  const std::string whole = text_of(folder / "a.tif");
  for (std::size_t size = 8; size < whole.size(); size += 7) {
    put_text(folder / "cut.tif", whole.substr(0, size));
    auto source = open_pictures(folder / "cut.tif", {});
    for (int i = 0; source && i < 6; ++i) static_cast<void>((*source)->next());
  }
}

TEST(JpegReader, LumaIsReadAndRotatedByItsExifTag) {
  const TestFolder folder;
  write_jpeg(folder / "a.jpg", "");
  const Picture plain = read_picture(folder / "a.jpg").value();
  EXPECT_EQ(plain.codec, "jpeg");
  EXPECT_NEAR(std::get<0>(plain.grey).at(0, 0), 40, 1);
  EXPECT_NEAR(std::get<0>(plain.grey).at(15, 0), 200, 1);
  write_jpeg(folder / "b.jpg", exif_of(6));  // rotate clockwise: the stored left side becomes the top
  const Picture turned = read_picture(folder / "b.jpg").value();
  EXPECT_EQ(turned.rotation_deg, 90);
  EXPECT_EQ(width_of(view_of(turned)), 8);
  EXPECT_NEAR(std::get<0>(turned.grey).at(0, 0), 40, 1);
  EXPECT_NEAR(std::get<0>(turned.grey).at(0, 15), 200, 1);
  write_jpeg(folder / "c.jpg", exif_of(2));
  EXPECT_EQ(read_picture(folder / "c.jpg").error().kind, InputErrorKind::kUnsupported) << "mirrored";
}

TEST(JpegReader, ATruncatedImageIsDamagedWithoutInventedGrey) {
  const TestFolder folder;
  write_jpeg(folder / "a.jpg", "");
  const std::string whole = text_of(folder / "a.jpg");
  put_text(folder / "a.jpg", whole.substr(0, whole.size() - 12));
  EXPECT_EQ(read_picture(folder / "a.jpg").error().kind, InputErrorKind::kDamaged);
}

TEST(ExifOrientation, ABlockWithAFalseLengthIsUpright) {
  const std::string whole = exif_of(6);
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(whole.data());
    const int orientation = exif_orientation({data, size});
    EXPECT_TRUE(orientation == 1 || orientation == 6 || orientation == 0) << size;
  }
}

TEST(PictureFile, AMissingFileAndATextHaveDifferentErrors) {
  const TestFolder folder;
  put_text(folder / "t.png", "text");
  EXPECT_EQ(read_picture(folder / "t.png").error().kind, InputErrorKind::kUnsupported);
  EXPECT_EQ(read_picture(folder / "absent.png").error().kind, InputErrorKind::kUnreadable);
}

}  // namespace
}  // namespace moiregauge::internal
