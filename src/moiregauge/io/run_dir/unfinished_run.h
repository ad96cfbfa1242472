// SPDX-License-Identifier: Apache-2.0
// Stores a run in progress in DIR.unfinished/run.mgj, frame by frame. The file survives a kill, and a later process can
// resume the run.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "moiregauge/base/output_error.h"
#include "moiregauge/io/journal/journal_file.h"
#include "moiregauge/io/journal/run_file.h"
#include "moiregauge/io/run_dir/run_place.h"
#include "moiregauge/run/journal_sink.h"

namespace moiregauge::internal {

// Action if an unfinished run is found: fail and change nothing, resume it, or delete it.
enum class Earlier { kAsk, kResume, kRestart };

// First words of the message of a run that another process is measuring.
inline constexpr std::string_view kRunInUse = "another process is measuring into the output folder";

// Returns true while another process, or another open file of this one, is measuring into DIR. False on file systems
// without locks.
[[nodiscard]] bool is_measured_elsewhere(const RunPlace& place);

class UnfinishedRun : public JournalSink {
 public:
  explicit UnfinishedRun(RunPlace place) : place_(std::move(place)) {}
  UnfinishedRun(const UnfinishedRun&) = delete;
  UnfinishedRun& operator=(const UnfinishedRun&) = delete;
  UnfinishedRun(UnfinishedRun&&) = delete;
  UnfinishedRun& operator=(UnfinishedRun&&) = delete;
  ~UnfinishedRun() override;  // keeps the frames; without frames removes the folder

  // Starts the journal before the first frame. Returns the observations of an unfinished run, or empty ones (no
  // reference frame) for a new run.
  // Fails (usage) if an unfinished run is found that cannot or may not be resumed. Fails (usage) also if another
  // process is measuring, or if the folder holds other files. Fails (not usage) if nothing can be written.
  [[nodiscard]] tl::expected<ObservationLog, OutputError> begin(const RunStart& start, const MeasureOptions& options,
                                                                Earlier earlier);
  void refer(const Reference& reference, const std::vector<std::string>& notes) override;
  void add(const std::string& packed) override;
  [[nodiscard]] bool good() const override { return journal_->good(); }
  // Syncs all records. Fails with a message for the user.
  [[nodiscard]] tl::expected<void, OutputError> close();
  // Completes the file after close(). `seen` holds all observations, `options` those of the results.
  [[nodiscard]] tl::expected<void, OutputError> end(const ObservationLog& seen, const MeasureOptions& options);

 private:
  // The locked journal. That of an interrupted run may be in DIR. No value of the result of find(): there is none.
  struct Found {
    int file = -1;
    bool in_results = false;
    tl::expected<KeptRun, std::string> kept;
  };
  [[nodiscard]] tl::expected<std::optional<Found>, OutputError> find();
  [[nodiscard]] tl::expected<ObservationLog, OutputError> start_new(const RunStart& start,
                                                                    const MeasureOptions& options, int locked);
  [[nodiscard]] tl::expected<ObservationLog, OutputError> may_continue(Found found);
  [[nodiscard]] tl::expected<void, OutputError> judge(const Found& found, const RunStart& start,
                                                      const MeasureOptions& options, Earlier earlier) const;
  [[nodiscard]] OutputError unwritable(const std::string& why) const;
  [[nodiscard]] std::string in_use() const;
  [[nodiscard]] std::string journal_path() const { return (place_.unfinished / kRunFileName).string(); }

  RunPlace place_;
  int file_ = -1;
  long frames_ = 0;  // frames stored, earlier ones included
  bool is_whole_ = false;
  std::unique_ptr<JournalFile> journal_;
};

}  // namespace moiregauge::internal
