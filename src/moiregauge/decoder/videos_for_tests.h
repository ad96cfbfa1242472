// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "moiregauge/decoder/video_source.h"

namespace moiregauge::internal::test {

inline void ffmpeg(const std::string& words) {
  ASSERT_EQ(std::system(("ffmpeg -nostdin -v error -y " + words).c_str()), 0) << words;
}

inline std::unique_ptr<FrameSource> opened(const std::string& path, const DecoderOptions& decoder = {}) {
  auto source = open_video(path, {}, decoder);
  if (source) return std::move(*source);
  ADD_FAILURE() << source.error().message;
  return nullptr;
}

}  // namespace moiregauge::internal::test
