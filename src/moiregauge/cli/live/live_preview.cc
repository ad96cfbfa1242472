// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/live/live_preview.h"

#include <cstdio>
#include <fstream>

#include "moiregauge/image/upper_bits.h"
#include "moiregauge/io/pictures/luma_jpeg.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::chrono::milliseconds kPreviewEvery(200);
constexpr int kPreviewWidth = 960;  // px

}  // namespace

LivePreview::~LivePreview() { std::remove(path_.c_str()); }

void LivePreview::add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) {
  if (next_ != nullptr) next_->add(frame, bits, reference, seen);
  const auto now = std::chrono::steady_clock::now();
  if (now - written_ < kPreviewEvery) return;
  written_ = now;
  const std::string jpeg = luma_jpeg(shrunk_to_width(upper_bits(frame.luma, bits).view(), kPreviewWidth).view());
  const std::string part = path_ + ".part";
  {
    std::ofstream out(part, std::ios::binary | std::ios::trunc);
    out << jpeg;
  }
  if (std::rename(part.c_str(), path_.c_str()) != 0) std::remove(part.c_str());
}

}  // namespace moiregauge::internal::cli
