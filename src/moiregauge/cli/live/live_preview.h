// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "moiregauge/run/frame_sink.h"

namespace moiregauge::internal::cli {

// Writes the newest frame as a grey JPEG of at most 960 px width, five times a second (--preview). The file is always
// whole. A failure to write is ignored, because the picture is for looking only.
class LivePreview final : public FrameSink {
 public:
  // `next` receives every frame too; null: none.
  LivePreview(std::string path, FrameSink* next) : path_(std::move(path)), next_(next) {}
  LivePreview(const LivePreview&) = delete;
  LivePreview& operator=(const LivePreview&) = delete;
  ~LivePreview() override;  // deletes the file
  void add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) override;

 private:
  std::string path_;
  FrameSink* next_;
  std::chrono::steady_clock::time_point written_{};
};

}  // namespace moiregauge::internal::cli
