// SPDX-License-Identifier: Apache-2.0
// One run directory of a live run while it grows: run.mgj and live.csv. Afterwards it is solved from its own file, so
// that memory does not grow with it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "moiregauge/app/measurement_run.h"

namespace moiregauge::internal {

class JournalFile;

// The end of a segment: what is stored after its observations.
struct SegmentEnd {
  ObservationLog log;  // without reference frame and observations; `notes`: damage and refusal only
  std::string refusal;
  std::string contradiction;
  std::string live_json;
  std::function<std::vector<std::uint8_t>(const Measurement&)> overlay;
};

class LiveSegment {
 public:
  LiveSegment(RunPlace place, MeasureOptions options);
  LiveSegment(const LiveSegment&) = delete;
  LiveSegment& operator=(const LiveSegment&) = delete;
  ~LiveSegment();

  // Starts the files, or continues them. Returns the observations so far (UnfinishedRun::begin).
  [[nodiscard]] tl::expected<ObservationLog, OutputError> open(const RunStart& start, Earlier earlier);
  [[nodiscard]] UnfinishedRun& journal() { return journal_; }
  // Adds rows to live.csv. `text` is called on the thread that writes. Rows that cannot be written are lost, but not
  // their observations.
  void put(std::function<std::string()> text);
  [[nodiscard]] bool can_put() const;
  // Writes overlay.png while the run grows.
  void show(const std::vector<std::uint8_t>& overlay) const;

  // Writes everything to disk, solves the run from its file, and publishes the run directory.
  [[nodiscard]] tl::expected<FinishedRun, RunFailure> finish(const SegmentEnd& end);
  [[nodiscard]] const RunPlace& place() const { return place_; }

 private:
  [[nodiscard]] bool open_rows(long last_frame);
  RunPlace place_;
  MeasureOptions options_;
  UnfinishedRun journal_;
  int rows_file_ = -1;
  std::unique_ptr<JournalFile> rows_;
};

}  // namespace moiregauge::internal
