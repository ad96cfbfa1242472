// SPDX-License-Identifier: Apache-2.0
// Measurement of a camera's frames one by one, in constant memory.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "moiregauge/image.h"
#include "moiregauge/measure.h"

namespace moiregauge {

// Displacements of all targets in the latest frame.
struct TrackedFrame {
  std::vector<Sample> samples;  // in the order of Tracker::target_names
  bool is_reference = false;    // this frame became the reference frame
  std::string problem;          // why the frame is not measured; empty if it is
};

// Follows the markers of a live camera. The first measurable frame is the reference frame. The scene (lens, positions)
// is solved from key frames after 2, 4, 8, 16, ... frames. Every sample has the u of the scene then in force.
// At most kMaxKeyFrames frames are kept, so memory does not grow with the number of frames.
// A sample is that of `measure` on the same frames within its u, once the camera has shown its usual movement.
// Assumption: the rows of a frame are read at once (global shutter). Contradicting footage is `untrusted`.
class Tracker {
 public:
  static constexpr int kMaxKeyFrames = 128;

  // Creates a tracker. Uses of the options: pitch, site, site_file, camera, camera_file, method ("precise"), tone. `auto`
  // tone of a camera's frames is linear unless the edges of the gratings show another curve.
  // Fails (kUsage): the options contain mistakes.
  [[nodiscard]] static MOIREGAUGE_API Expected<Tracker> create(const MeasureOptions& options);

  // Measures one frame. `time_s` must rise. All frames must have the size and depth of the first.
  // Fails (kInput): the frame has another size or depth.
  [[nodiscard]] MOIREGAUGE_API Expected<TrackedFrame> update(const ImageView& image, double time_s);

  // Returns the names of the targets; empty before the reference frame.
  [[nodiscard]] MOIREGAUGE_API const std::vector<std::string>& target_names() const;
  // Returns the number of frames measured so far.
  [[nodiscard]] MOIREGAUGE_API long frames() const;
  // Returns warnings about the scene in force, each once.
  [[nodiscard]] MOIREGAUGE_API std::vector<std::string> warnings() const;

  MOIREGAUGE_API Tracker(Tracker&&) noexcept;
  MOIREGAUGE_API Tracker& operator=(Tracker&&) noexcept;
  MOIREGAUGE_API ~Tracker();

 private:
  struct State;
  explicit Tracker(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace moiregauge
