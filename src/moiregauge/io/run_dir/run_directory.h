// SPDX-License-Identifier: Apache-2.0
// DIR of a run: displacement.csv, displacement.h5, run.json, run.mgj, overlay.png, report.html, of a solved scene camera.toml and
// site.toml; written beside it under another name and put in its place as a whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "moiregauge/io/run_dir/run_place.h"
#include "moiregauge/run/result_sink.h"

namespace moiregauge::internal {

// Draws overlay.png, nothing where there is no picture; handed in, because io does not know drawing.
using DrawOverlay = std::function<std::vector<std::uint8_t>(const Measurement&)>;

// Puts more files into the folder of the results, before it takes its place; errors read "path: why".
using PutMore = std::function<tl::expected<void, std::string>(const std::filesystem::path& folder, const Measurement&)>;

// Writes report.html, given run.json and overlay.png as they are written beside it; handed in for the same reason.
using WriteReport = std::function<std::string(const Measurement&, const MeasureOptions&, const std::string& run_json,
                                              const std::vector<std::uint8_t>& overlay)>;

class RunDirectory : public ResultSink {
 public:
  // For what was just measured: its run.mgj, whole, lies in DIR.unfinished (unfinished_run.h).
  RunDirectory(RunPlace place, DrawOverlay draw_overlay, WriteReport write_report)
      : place_(std::move(place)), draw_overlay_(std::move(draw_overlay)), write_report_(std::move(write_report)) {}
  // For new results of what was measured into another folder, or the same: its run.mgj and overlay.png are kept.
  [[nodiscard]] static RunDirectory solved_from(RunPlace place, std::string measured, WriteReport write_report) {
    RunDirectory directory(std::move(place), {}, std::move(write_report));
    directory.solved_from_ = std::move(measured);
    return directory;
  }

  // One more of them; called after the results are written, in the order given.
  void also(PutMore more) { more_.push_back(std::move(more)); }

  // May this place be written? An existing run is replaced only if it came from the same input; anything else that is not
  // an empty folder is left alone. Asked before measuring, so that hours are not lost.
  // The input's fingerprint takes a pass over all its bytes: it is asked for only where a run stands already.
  [[nodiscard]] tl::expected<void, OutputError> check(const std::function<std::string()>& input_sha256) const;
  // What a run that was interrupted has so far stays in DIR.unfinished where a finished run stands in DIR.
  [[nodiscard]] tl::expected<void, OutputError> write(const Measurement& measurement,
                                                      const MeasureOptions& options) override;
  // After write(): where the results are, as the user would type it.
  [[nodiscard]] std::string results() const { return place_.shown + (is_unfinished_ ? ".unfinished" : ""); }

 private:
  [[nodiscard]] tl::expected<void, std::string> put_files(const std::filesystem::path& dir,
                                                          const Measurement& measurement,
                                                          const MeasureOptions& options) const;
  [[nodiscard]] OutputError unwritable(const std::string& why, const Measurement& measurement) const;
  RunPlace place_;
  DrawOverlay draw_overlay_;
  std::vector<PutMore> more_;
  WriteReport write_report_;
  std::string solved_from_;  // empty: just measured
  bool is_unfinished_ = false;
};

}  // namespace moiregauge::internal
