// SPDX-License-Identifier: Apache-2.0
#include "studies/world/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace world {
namespace {

using Bytes = std::vector<unsigned char>;

void append_number(Bytes& to, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<unsigned char>(value >> shift));
}

std::uint32_t crc32(const Bytes& bytes, std::size_t from) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = (c & 1U) != 0U ? 0xEDB88320U ^ (c >> 1U) : c >> 1U;
      t[n] = c;
    }
    return t;
  }();
  std::uint32_t c = 0xFFFFFFFFU;
  for (std::size_t i = from; i < bytes.size(); ++i) c = table[(c ^ bytes[i]) & 0xFFU] ^ (c >> 8U);
  return ~c;
}

void append_chunk(Bytes& to, const char* type, const Bytes& content) {
  append_number(to, static_cast<std::uint32_t>(content.size()));
  const std::size_t begin = to.size();
  to.insert(to.end(), type, type + 4);
  to.insert(to.end(), content.begin(), content.end());
  append_number(to, crc32(to, begin));
}

// Wraps bytes in stored blocks of deflate (RFC 1950 and 1951).
Bytes stored_stream(const Bytes& raw) {
  Bytes out = {0x78, 0x01};
  std::uint32_t a = 1, b = 0;
  for (std::size_t at = 0; at < raw.size();) {
    const std::size_t count = std::min<std::size_t>(65535, raw.size() - at);
    const auto size = static_cast<unsigned>(count), complement = size ^ 0xFFFFU;
    out.push_back(at + count == raw.size() ? 1 : 0);
    for (const unsigned value : {size, complement}) {
      out.push_back(static_cast<unsigned char>(value & 0xFFU));
      out.push_back(static_cast<unsigned char>(value >> 8U));
    }
    for (const std::size_t end = at + count; at < end; ++at) {
      out.push_back(raw[at]);
      a = (a + raw[at]) % 65521U;
      b = (b + a) % 65521U;
    }
  }
  append_number(out, (b << 16U) | a);
  return out;
}

}  // namespace

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
  Bytes raw, header, file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  const auto columns = static_cast<std::size_t>(width);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (i % columns == 0) raw.push_back(0);
    if (bits > 8) raw.push_back(static_cast<unsigned char>(levels[i] >> 8U));
    raw.push_back(static_cast<unsigned char>(levels[i] & 0xFFU));
  }
  append_number(header, static_cast<std::uint32_t>(width));
  append_number(header, static_cast<std::uint32_t>(levels.size() / columns));
  header.insert(header.end(), {static_cast<unsigned char>(bits > 8 ? 16 : 8), 0, 0, 0, 0});
  append_chunk(file, "IHDR", header);
  append_chunk(file, "IDAT", stored_stream(raw));
  append_chunk(file, "IEND", {});
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  if (!out) throw std::runtime_error("cannot write " + path);
}

}  // namespace world
