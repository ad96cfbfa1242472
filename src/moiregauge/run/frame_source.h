// SPDX-License-Identifier: Apache-2.0
// Interface that delivers frames. Implementations: `io` (image folders, TIFF) and `decoder` (video files).
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

// Block `input` of run.json.
struct InputInfo {
  std::string path;
  std::string sha256;       // hashes the file's bytes, or all bytes of a folder's images in order. Sources leave it
                            // empty, because it is computed during the measurement (app/fingerprint.h)
  long frames = -1;         // number of frames in the input; -1: unknown before the end
  int width = 0;            // px, as displayed
  int height = 0;           // px, as displayed
  int bits = 8;             // bits per grey level
  double fps = 0.0;         // nominal, frames/s of the scene; NaN if unknown
  std::string codec;        // "png", "jpeg", "tiff", "ffv1", "h264" ...
  int rotation_deg = 0;     // clockwise rotation applied for display, a multiple of 90
  std::string time_source;  // "stream", "fps-option", "none"
  Tone tone;                // tone curve of its grey levels
  std::vector<std::string> warnings;
  double slow_motion = 1.0;  // --slow-motion: frame rate of the recording by that of the file
  // Start as stated by the file, e.g. "2026-05-04T09:12:33Z"; empty: not stated. Cameras often write another time.
  std::string start_utc;
};

struct Frame {
  long number = 0;           // index in the input, the first is 0
  double time_s = 0.0;       // s since frame 0 in the scene, by the stream's time stamps; NaN if unknown
  bool damaged = false;      // the decoder reported an error in this frame
  LumaView luma;             // valid until the next call of next()
  QuantiserMap quantiser{};  // quantiser of a lossy codec, grey levels of `luma`; valid as long as `luma`
};

enum class InputErrorKind { kUnreadable, kUnsupported, kDamaged };

struct InputError {
  InputErrorKind kind = InputErrorKind::kUnreadable;
  std::string message;  // "what happened: where: what to do"
};
[[nodiscard]] inline tl::unexpected<InputError> input_failure(InputErrorKind kind, std::string message) {
  return tl::unexpected(InputError{kind, std::move(message)});
}

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual const InputInfo& info() const = 0;
  // Returns the next frame, or nullopt at the regular end. Fails if the input ends early: earlier frames stay valid.
  [[nodiscard]] virtual tl::expected<std::optional<Frame>, InputError> next() = 0;
  // Returns true if the pixels of the last frame were intact while it was measured. A memory-mapped file may be
  // truncated meanwhile. Call it after each measurement.
  [[nodiscard]] virtual bool is_frame_whole() const { return true; }
};

struct InputOptions {
  std::optional<double> fps;             // --fps: time stamps of images, frames/s; replaces those of a stream
  std::optional<double> slow_motion{};   // --slow-motion: divides all times
  bool sequence = false;                 // --sequence: the path is a printf pattern
  int threads = 0;                       // --threads: threads that read images ahead; 0: one per core, 1: none
  std::int64_t max_pixels = 64'000'000;  // --max-pixels: larger images are not decoded
};

}  // namespace moiregauge::internal
