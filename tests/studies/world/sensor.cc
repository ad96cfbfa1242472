// SPDX-License-Identifier: Apache-2.0
#include "studies/world/sensor.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>

namespace world {

Sensor::Sensor(const DrawFile& draw) : random_(static_cast<std::uint64_t>(draw.number("seed"))) {
  tone_ = draw.words("sensor.tone").at(0);
  tone_value_ = std::stod(draw.words("sensor.tone").at(1));
  const auto numbers = draw.numbers("sensor.noise", 6), size = draw.numbers("image", 2);
  white_ = numbers[0], full_well_ = numbers[1], read_noise_ = numbers[2], pedestal_ = numbers[5];
  bits_ = static_cast<int>(draw.number("sensor.bits"));
  std::normal_distribution<double> normal;
  for (double i = 0; i < size[0] * size[1]; ++i) {
    gain_.push_back(static_cast<float>(1.0 + numbers[3] * normal(random_)));
    dark_.push_back(static_cast<float>(numbers[4] * std::abs(normal(random_))));
  }
}

double Sensor::stored(double light) const {
  const double x = std::clamp(light, 0.0, 1.0);
  const auto srgb = [](double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055; };
  if (tone_ == "linear") return x;
  if (tone_ == "srgb") return srgb(x);
  if (tone_ == "gamma") return std::pow(x, 1.0 / tone_value_);
  if (tone_ == "s-curve") {  // steeper in the middle, flat at both ends
    const double y = srgb(x), k = tone_value_;
    const auto s = [&](double v) { return 1.0 / (1.0 + std::exp(-k * (v - 0.5))); };
    return (s(y) - s(0.0)) / (s(1.0) - s(0.0));
  }
  throw std::runtime_error("unknown tone curve: " + tone_);
}

std::vector<std::uint16_t> Sensor::levels(const Picture& light) {
  std::normal_distribution<double> normal;
  std::vector<std::uint16_t> out(light.values.size());
  const double top = std::pow(2.0, bits_) - 1.0;
  constexpr int kSteps = 1 << 14;
  std::vector<double> curve;
  for (int i = 0; i <= kSteps + 1; ++i) curve.push_back(stored(static_cast<double>(i) / kSteps));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double electrons =
        full_well_ * white_ * static_cast<double>(light.values[i]) * static_cast<double>(gain_[i]) +
        static_cast<double>(dark_[i]);
    const double noise =
        std::sqrt(std::max(0.0, electrons) * (full_well_ < 1e8 ? 1.0 : 0.0) + read_noise_ * read_noise_);
    const double x = std::clamp((electrons + noise * normal(random_)) / full_well_ + pedestal_, 0.0, 1.0) * kSteps;
    const auto below = static_cast<std::size_t>(x);
    const double y = curve[below] + (x - static_cast<double>(below)) * (curve[below + 1] - curve[below]);
    out[i] = static_cast<std::uint16_t>(std::lround(y * top));
  }
  return out;
}

void write_png(const std::string& path, const std::vector<std::uint16_t>& levels, int width, int bits) {
  const int depth = bits > 8 ? 16 : 8;
  const auto row_bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(depth / 8);
  std::vector<png_byte> bytes;  // high byte first
  for (const std::uint16_t level : levels) {
    if (depth == 16) bytes.push_back(static_cast<png_byte>(level >> 8U));
    bytes.push_back(static_cast<png_byte>(level & 0xFFU));
  }
  std::vector<png_bytep> rows;
  for (std::size_t at = 0; at < bytes.size(); at += row_bytes) rows.push_back(bytes.data() + at);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
  // An exception must not pass through a C library.
  const auto fail = [](png_structp, png_const_charp what) {
    std::fprintf(stderr, "error: %s\n", what);
    std::exit(1);
  };
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (!file || info == nullptr) throw std::runtime_error("cannot write " + path);
  png_init_io(png, file.get());
  png_set_compression_level(png, 1);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(rows.size()), depth,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_rows(png, info, rows.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  if (std::fflush(file.get()) != 0) throw std::runtime_error("cannot write " + path);
}

}  // namespace world
