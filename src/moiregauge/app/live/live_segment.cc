// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/live_segment.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/io/journal/journal_file.h"
#include "moiregauge/io/run_dir/run_directory.h"
#include "moiregauge/report/report_page.h"
#include "moiregauge/run/observing_run.h"

namespace moiregauge::internal {
namespace {

constexpr std::string_view kRowsHeader =
    "frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status,device_ns,host_ns,utc_ns\n";

long frame_of_row(std::string_view line) {
  long frame = -1;
  std::from_chars(line.data(), line.data() + line.size(), frame);
  return frame;
}

// Returns the size of the rows that belong to kept frames. A kill may leave rows of frames that the journal lost, and
// a part of a row.
std::size_t valid_size(const std::string& path, long last_frame) {
  constexpr std::streamoff kTail = 1 << 20;  // rows of far more than a second
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return 0;
  const std::streamoff size = file.tellg();
  const std::streamoff begin = std::max<std::streamoff>(0, size - kTail);
  std::string tail(static_cast<std::size_t>(size - begin), '\0');
  file.seekg(begin).read(tail.data(), static_cast<std::streamsize>(tail.size()));
  std::size_t end = tail.rfind('\n');
  while (end != std::string::npos) {
    const std::size_t start = end == 0 ? std::string::npos : tail.rfind('\n', end - 1);
    const std::size_t first = start == std::string::npos ? 0 : start + 1;
    if (frame_of_row(std::string_view(tail).substr(first, end - first)) <= last_frame)
      return static_cast<std::size_t>(begin) + end + 1;
    end = start;
  }
  return 0;
}

}  // namespace

LiveSegment::LiveSegment(RunPlace place, MeasureOptions options)
    : place_(std::move(place)), options_(std::move(options)), journal_(place_) {}

LiveSegment::~LiveSegment() {
  rows_.reset();  // writes pending rows
  if (rows_file_ >= 0) ::close(rows_file_);
}

tl::expected<ObservationLog, OutputError> LiveSegment::open(const RunStart& start, Earlier earlier) {
  auto so_far = journal_.begin(start, options_, earlier);
  if (!so_far) return so_far;
  const bool is_kept = so_far->reference && !so_far->observations.empty();
  if (!open_rows(is_kept ? so_far->observations.back().frame : -1))
    return tl::unexpected(
        OutputError{false, fmt::format("the results could not be written: {}.unfinished/{} ({}): free space or choose "
                                       "another folder with -o",
                                       place_.shown, kLiveRowsName, std::strerror(errno))});
  return so_far;
}

bool LiveSegment::open_rows(long last_frame) {
  const std::string path = (place_.unfinished / kLiveRowsName).string();
  const std::size_t size = last_frame < 0 ? 0 : valid_size(path, last_frame);
  rows_file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (rows_file_ < 0 || ::ftruncate(rows_file_, static_cast<off_t>(size)) != 0) return false;
  rows_ = std::make_unique<JournalFile>(rows_file_, size, 0);
  if (size == 0 && !rows_->append(kRowsHeader)) return false;
  rows_->start();
  return true;
}

void LiveSegment::put(std::function<std::string()> text) { rows_->add(std::move(text), true); }

bool LiveSegment::can_put() const { return rows_->good(); }

void LiveSegment::show(const std::vector<std::uint8_t>& overlay) const {
  const std::string_view bytes{reinterpret_cast<const char*>(overlay.data()), overlay.size()};
  if (!bytes.empty()) (void)write_file_atomically((place_.unfinished / "overlay.png").string(), bytes);
}

tl::expected<FinishedRun, RunFailure> LiveSegment::finish(const SegmentEnd& end) {
  const auto failed = [](const OutputError& error) { return tl::unexpected(failure_of(error)); };
  (void)rows_->finish();
  if (const auto closed = journal_.close(); !closed) return failed(closed.error());
  auto kept = recover_run((place_.unfinished / kRunFileName).string());
  if (!kept) return tl::unexpected(RunFailure{Exit::kInternalError, kept.error()});
  FinishedRun done;
  Measurement& measured = done.measurement;
  static_cast<ObservationLog&>(measured) = std::move(kept->run.seen);
  measured.input = end.log.input;
  measured.input_damaged = end.log.input_damaged;
  measured.interrupted = false;
  measured.refusal = end.refusal;
  measured.contradiction = end.contradiction;
  measured.notes.insert(measured.notes.end(), end.log.notes.begin(), end.log.notes.end());
  CameraProcessing processing = end.log.processing;
  if (!measured.observations.empty()) {
    const long first = measured.observations.front().frame;
    std::erase_if(processing.repeated, [first](long frame) { return frame < first; });
  }
  conclude_log(processing, static_cast<long>(measured.observations.size()), measured);
  evaluate(options_, measured);
  if (!end.contradiction.empty()) return tl::unexpected(RunFailure{Exit::kUsage, end.contradiction});
  RunDirectory directory(place_, end.overlay, report_page);
  directory.also([&end](const std::filesystem::path& folder, const Measurement&) {
    return write_file_atomically((folder / kLiveFactsName).string(), end.live_json);
  });
  const auto written = journal_.end(measured, options_).and_then([&] { return directory.write(measured, options_); });
  if (!written) return failed(written.error());
  done.folder = directory.results();
  return done;
}

}  // namespace moiregauge::internal
