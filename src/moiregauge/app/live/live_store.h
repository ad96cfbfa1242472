// SPDX-License-Identifier: Apache-2.0
// Stores a live run: one run directory, or a folder of segments that are each one. The measuring thread never waits for
// a disk.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/app/live/live_segment.h"
#include "moiregauge/app/live/task_queue.h"
#include "moiregauge/live/publisher.h"
#include "moiregauge/run/journal_sink.h"

namespace moiregauge::internal {

struct LiveStoreOptions {
  std::string folder;  // DIR
  Earlier earlier = Earlier::kAsk;
  double segment_s = std::numeric_limits<double>::infinity();       // --segment
  double keep_s = std::numeric_limits<double>::infinity();          // --keep
  std::uint64_t quota = std::numeric_limits<std::uint64_t>::max();  // --quota, bytes
  bool may_wait = false;  // the source waits for the measurement, so nothing is lost by waiting for the disk

  [[nodiscard]] bool has_segments() const { return segment_s < std::numeric_limits<double>::infinity(); }
};

// Result of a stored run.
struct LiveStored {
  std::optional<FinishedRun> run;     // without --segment
  std::vector<std::string> segments;  // folders that were finished, the oldest first
  long rows = 0, ok_rows = 0;         // in all segments, as solved
  std::optional<RunFailure> trouble;  // a segment could not be finished; its frames are kept
};

class LiveStore final : public JournalSink, public Publisher {
 public:
  // `end`: returns the end of the present segment. The measuring thread calls it.
  using EndOf = std::function<SegmentEnd()>;
  LiveStore(LiveStoreOptions options, RunStart start, MeasureOptions measure, EndOf end);

  // Opens the files. Returns the observations to continue with, or none.
  // Fails: an earlier run is there and may not be continued, or nothing can be written.
  [[nodiscard]] tl::expected<ObservationLog, RunFailure> open();
  // Begins the next segment if it is due. Call it before each frame. `time_s`: time of that frame.
  void begin_frame(double time_s);
  // Draws and stores the overlay of the reference frame in the background.
  void show_reference(const Measurement& log);
  // Completes all segments. `end`: how the last one ends.
  [[nodiscard]] LiveStored finish_all(SegmentEnd end);

  void refer(const Reference& reference, const std::vector<std::string>& notes) override;
  void add(const std::string& packed) override;
  [[nodiscard]] bool good() const override { return current_->journal().good(); }

  void start(const LiveRun& run) override;
  void put(const PublishedFrame& frame) override;
  void finish(double /*seconds*/) override {}
  [[nodiscard]] long lost_rows() const override { return lost_rows_; }
  [[nodiscard]] std::pair<std::string, std::string> state() const override {
    return {"live.csv", lost_rows_ == 0 ? "written" : "rows could not be written"};
  }

 private:
  using Segment = std::unique_ptr<LiveSegment>;
  using Ended = std::pair<Segment, SegmentEnd>;
  struct Found;
  [[nodiscard]] tl::expected<ObservationLog, RunFailure> open_single();
  [[nodiscard]] tl::expected<ObservationLog, RunFailure> open_segments();
  [[nodiscard]] tl::expected<Found, RunFailure> earlier_segments();
  [[nodiscard]] tl::expected<ObservationLog, RunFailure> take_kept(long number, std::vector<Ended>& kept_segments);
  [[nodiscard]] tl::expected<ObservationLog, RunFailure> take_finished(long number) const;
  [[nodiscard]] std::string folder_of(long number) const;
  [[nodiscard]] tl::expected<Segment, OutputError> new_segment(long number);
  void continue_from(const ObservationLog& log);
  void prepare_next();
  [[nodiscard]] Segment take_next();
  void finish_later(Segment segment, SegmentEnd end);
  void complete(LiveSegment& segment, const SegmentEnd& end);
  void delete_old() const;

  const LiveStoreOptions options_;
  RunStart start_;
  MeasureOptions measure_;  // for the next segment
  EndOf end_;
  Segment current_;
  long number_ = 0;  // current segment
  long index_ = 0;   // current multiple of segment_s
  std::atomic<long> lost_rows_ = 0;
  long frames_ = 0;  // in the current segment
  std::shared_ptr<const Reference> reference_;
  std::vector<std::string> notes_;
  std::shared_ptr<const std::vector<std::string>> names_;  // all markers
  mutable std::mutex mutex_;
  Segment next_;                       // shared
  std::vector<std::uint8_t> overlay_;  // used by the tasks, and by others only while there are none
  LiveStored stored_;                  // the same
  std::unique_ptr<TaskQueue> tasks_;   // last: it uses all members above
};

}  // namespace moiregauge::internal
