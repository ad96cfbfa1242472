// SPDX-License-Identifier: Apache-2.0
// Writes the folder DIR of a run: displacement.csv, displacement.h5, run.json, run.mgj, overlay.png and report.html. A
// solved scene adds camera.toml and site.toml. The folder is written next to DIR and replaces it as a whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "moiregauge/io/run_dir/run_place.h"
#include "moiregauge/run/result_sink.h"

namespace moiregauge::internal {

// Draws overlay.png. Returns nothing without an image. Passed in, because `io` must not depend on `drawing`.
using DrawOverlay = std::function<std::vector<std::uint8_t>(const Measurement&)>;

// Adds files to the folder of the results before it is published. Errors name the path and the reason.
using PutMore = std::function<tl::expected<void, std::string>(const std::filesystem::path& folder, const Measurement&)>;

// Writes report.html from run.json and overlay.png. Passed in for the same reason.
using WriteReport = std::function<std::string(const Measurement&, const MeasureOptions&, const std::string& run_json,
                                              const std::vector<std::uint8_t>& overlay)>;

class RunDirectory : public ResultSink {
 public:
  // Creates the folder of a new measurement. Its complete run.mgj is in DIR.unfinished (unfinished_run.h).
  RunDirectory(RunPlace place, DrawOverlay draw_overlay, WriteReport write_report)
      : place_(std::move(place)), draw_overlay_(std::move(draw_overlay)), write_report_(std::move(write_report)) {}
  // Creates the folder of new results of an earlier measurement in `measured`. Its run.mgj, overlay.png and
  // stabilised.mp4 are kept.
  [[nodiscard]] static RunDirectory solved_from(RunPlace place, std::string measured, WriteReport write_report) {
    RunDirectory directory(std::move(place), {}, std::move(write_report));
    directory.solved_from_ = std::move(measured);
    return directory;
  }

  // Adds a writer of further files. Writers run after the results are written, in the order of these calls.
  void also(PutMore more) { more_.push_back(std::move(more)); }

  // Checks that DIR may be written: it is new, empty, or holds a run of the same input. Call it before the measurement,
  // which may take hours.
  // `input_sha256` reads the whole input, so it is called only if DIR holds a run.
  [[nodiscard]] tl::expected<void, OutputError> check(const std::function<std::string()>& input_sha256) const;
  // Writes the results. An interrupted run stays in DIR.unfinished if DIR holds a finished run.
  [[nodiscard]] tl::expected<void, OutputError> write(const Measurement& measurement,
                                                      const MeasureOptions& options) override;
  // Returns the folder of the results as the user would type it. Call it after write().
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
  std::string solved_from_;  // empty: new measurement
  bool is_unfinished_ = false;
};

}  // namespace moiregauge::internal
