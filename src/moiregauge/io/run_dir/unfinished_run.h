// SPDX-License-Identifier: Apache-2.0
// A run while it is under way: DIR.unfinished/run.mgj, to which every frame is added as it is measured. A process that
// is killed leaves it there, and the next one can go on with it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/base/output_error.h"
#include "moiregauge/io/journal/journal_file.h"
#include "moiregauge/io/journal/run_file.h"
#include "moiregauge/io/run_dir/run_place.h"
#include "moiregauge/run/journal_sink.h"

namespace moiregauge::internal {

// What to do where an unfinished run is found: say so and touch nothing; go on with it; throw it away.
enum class Earlier { kAsk, kResume, kRestart };

class UnfinishedRun : public JournalSink {
 public:
  explicit UnfinishedRun(RunPlace place) : place_(std::move(place)) {}
  UnfinishedRun(const UnfinishedRun&) = delete;
  UnfinishedRun& operator=(const UnfinishedRun&) = delete;
  ~UnfinishedRun() override;  // keeps the frames; where there are none nothing is left behind

  // Before any frame. Returns what an earlier run found, nothing (no reference frame) where there is none to go on
  // with. Fails (usage) where one is found and cannot or may not be gone on with, where another process is at work, or
  // where the place is somebody else's; (not usage) where nothing can be written.
  [[nodiscard]] tl::expected<ObservationLog, OutputError> begin(const RunStart& start, const MeasureOptions& options,
                                                                Earlier earlier);
  void refer(const Reference& reference, const std::vector<std::string>& notes) override;
  void add(const std::string& packed) override;
  [[nodiscard]] bool good() const override { return journal_->good(); }
  // All that was added is on the disk. Fails with what to tell the user.
  [[nodiscard]] tl::expected<void, OutputError> close();
  // After close(): the run is whole, `seen` is all of it. Results that were concluded from it had these options.
  [[nodiscard]] tl::expected<void, OutputError> end(const ObservationLog& seen, const MeasureOptions& options);

 private:
  // The journal, locked; of a run that was interrupted it may lie in DIR. No value: there is none.
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
  long frames_ = 0;  // kept and added
  bool is_whole_ = false;
  std::unique_ptr<JournalFile> journal_;
};

}  // namespace moiregauge::internal
