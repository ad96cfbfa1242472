// SPDX-License-Identifier: Apache-2.0
// Interface that stores the frames of a recording. `app` implements it (lossless video).
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

class RecordingWriter {
 public:
  virtual ~RecordingWriter() = default;
  // Adds a frame. Times increase. Fails with the path and the reason.
  [[nodiscard]] virtual tl::expected<void, std::string> add(const LumaView& luma, double time_s) = 0;
  // Completes the recording, which is unusable without this call.
  [[nodiscard]] virtual tl::expected<void, std::string> finish() = 0;
};

struct RecordingFormat {
  std::string name;  // e.g. "alarm-000420", unique in the run
  int width = 0;     // px
  int height = 0;    // px
  int bits = 8;
};
// Creates a recording. Fails with the path and the reason.
using MakeRecordingWriter =
    std::function<tl::expected<std::unique_ptr<RecordingWriter>, std::string>(const RecordingFormat& format)>;

}  // namespace moiregauge::internal
