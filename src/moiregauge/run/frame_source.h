// SPDX-License-Identifier: Apache-2.0
// The door through which pictures come in. Implemented by io (folders of pictures, TIFF) and decoder (video files).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/image/image.h"
#include "moiregauge/image/quantiser.h"
#include "moiregauge/image/tone.h"

namespace moiregauge::internal {

// run.json's `input` block.
struct InputInfo {
  std::string path;
  std::string sha256;       // of the file's bytes; of a folder: over the pictures' bytes in order. A source leaves it
                            // empty: it is taken beside the measuring, not before it (app/fingerprint.h)
  long frames = -1;         // number of frames in the input; -1: not known before the end
  int width = 0;            // px, as displayed
  int height = 0;           // px, as displayed
  int bits = 8;             // grey-level depth
  double fps = 0.0;         // nominal; NaN when unknown
  std::string codec;        // "png", "jpeg", "tiff", "ffv1", "h264" ...
  int rotation_deg = 0;     // quarter turns clockwise that were applied to show the picture upright
  std::string time_source;  // "stream", "fps-option", "none"
  Tone tone;                // of its grey levels
  std::vector<std::string> warnings;
};

struct Frame {
  long number = 0;           // index in the input, first = 0
  double time_s = 0.0;       // from frame 0 by the stream's time stamps; NaN when unknown
  bool damaged = false;      // the decoder reported an error in it
  LumaView luma;             // valid until the next call of next()
  QuantiserMap quantiser{};  // of a lossy codec, in grey levels of `luma`; valid as long
};

enum class InputErrorKind { kUnreadable, kUnsupported, kDamaged };

struct InputError {
  InputErrorKind kind = InputErrorKind::kUnreadable;
  std::string message;  // "what: where: what to do"
};
[[nodiscard]] inline tl::unexpected<InputError> input_failure(InputErrorKind kind, std::string message) {
  return tl::unexpected(InputError{kind, std::move(message)});
}

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual const InputInfo& info() const = 0;
  // The next frame in order; nullopt at the regular end; an error when the input breaks off (earlier frames stay valid).
  [[nodiscard]] virtual tl::expected<std::optional<Frame>, InputError> next() = 0;
  // Asked after a frame was measured: were its pixels there until now? A file that is looked at in place may shrink.
  [[nodiscard]] virtual bool is_frame_whole() const { return true; }
};

struct InputOptions {
  std::optional<double> fps;             // --fps: time stamps of pictures; also overrides a stream's
  bool sequence = false;                 // --sequence: the path is a printf pattern
  int threads = 0;                       // --threads: that read pictures ahead; 0: as many as there are cores, 1: none
  std::int64_t max_pixels = 64'000'000;  // --max-pixels: a picture that claims more is not decoded
};

}  // namespace moiregauge::internal
