// SPDX-License-Identifier: Apache-2.0
// Keeps the seconds before and after an alarm as a recording that `measure` reads.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "moiregauge/live/record/marker_windows.h"
#include "moiregauge/live/record/recording_writer.h"
#include "moiregauge/live/row_block.h"
#include "moiregauge/run/frame_sink.h"

namespace moiregauge::internal {

struct RecordOptions {
  double seconds = 10.0;             // before and after an alarm
  double full_frame_every_s = 10.0;  // the other frames have windows around the markers only
  // Limit for the frames kept for an alarm. Twice as much may wait for the disk.
  std::size_t max_bytes = std::size_t{256} << 20;
};

// The reference frame comes first in each recording, whole, so that displacements have the run's zero. Frames are
// written on a thread of low priority. Frames that do not fit into `max_bytes` are lost and counted.
class AlarmRecorder final : public FrameSink, public AlarmListener {
 public:
  AlarmRecorder(const RecordOptions& options, MakeRecordingWriter make_writer);
  AlarmRecorder(const AlarmRecorder&) = delete;
  AlarmRecorder& operator=(const AlarmRecorder&) = delete;
  ~AlarmRecorder() override;

  // Both are called on the measuring thread, add() first for each frame. The first frame with a reference must be the
  // reference frame itself.
  void add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) override;
  void alarm(const AlarmEvent& event) override;
  // Completes recordings. No call comes after it.
  void finish();

  // Any thread:
  [[nodiscard]] long recordings() const;  // completed
  [[nodiscard]] long lost_frames() const;
  [[nodiscard]] std::string problem() const;  // reason why a recording could not be written; empty: none

 private:
  struct Begin {
    RecordingFormat format;
  };
  struct End {};
  using Job = std::variant<Begin, std::shared_ptr<const StoredFrame>, End>;

  void keep(std::shared_ptr<const StoredFrame> frame);
  void post(Job job);
  void write_all();
  void write(const Job& job);

  RecordOptions options_;
  MakeRecordingWriter make_writer_;
  // Used by the measuring thread:
  std::optional<MarkerWindows> windows_;
  std::shared_ptr<const StoredFrame> reference_;
  RecordingFormat format_;
  std::deque<std::shared_ptr<const StoredFrame>> ring_;
  std::size_t ring_bytes_ = 0;
  double last_full_s_ = 0.0;
  std::optional<double> until_s_;  // a recording runs until then
  bool is_finished_ = false;
  // Used by the writing thread:
  std::unique_ptr<RecordingWriter> writer_;
  std::optional<FrameCanvas> canvas_;
  // Shared:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::size_t waiting_bytes_ = 0;
  bool is_closing_ = false;
  long recordings_ = 0;
  long lost_ = 0;
  std::string problem_;
  std::thread thread_;
};

}  // namespace moiregauge::internal
