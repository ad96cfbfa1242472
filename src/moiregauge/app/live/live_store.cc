// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/live_store.h"

#include <malloc.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/csv_field.h"
#include "moiregauge/io/journal/run_identity.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using Failed = tl::unexpected<RunFailure>;

constexpr std::string_view kPrefix = "segment-";
constexpr std::string_view kUnfinished = ".unfinished";
constexpr std::size_t kMaxPending = 3;  // tasks; with more, the present segment becomes longer

Failed unusable_folder(std::string message) { return Failed(RunFailure{Exit::kUsage, std::move(message)}); }

std::vector<std::uint8_t> bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Returns the number of a segment's folder. Fails (nothing): it is another folder.
std::optional<long> number_of(std::string name, bool is_unfinished) {
  if (name.ends_with(kUnfinished) != is_unfinished || !name.starts_with(kPrefix)) return std::nullopt;
  if (is_unfinished) name.resize(name.size() - kUnfinished.size());
  long number = 0;
  const char* end = name.data() + name.size();
  const auto [last, error] = std::from_chars(name.data() + kPrefix.size(), end, number);
  if (error != std::errc() || last != end) return std::nullopt;
  return number;
}

std::vector<long> segments_in(const fs::path& folder, bool unfinished) {
  std::vector<long> numbers;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (const auto number = number_of(entry.path().filename().string(), unfinished)) numbers.push_back(*number);
  }
  std::ranges::sort(numbers);
  return numbers;
}

std::uint64_t size_of(const fs::path& folder) {
  std::uint64_t size = 0;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.is_regular_file(error)) size += entry.file_size(error);
  }
  return size;
}

double age_s(const fs::path& folder) {
  std::error_code error;
  const auto written = fs::last_write_time(folder / "run.json", error);
  if (error) return 0.0;
  return std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
}

std::string rows_text(const std::vector<std::string>& names, const PublishedFrame& frame) {
  std::string text;
  const std::string device = frame.device_ns ? fmt::format("{}", *frame.device_ns) : "NaN";
  for (const Sample& s : frame.rows) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", s.frame, csv_number(s.time_s), csv_field(names[s.marker]),
                        csv_number(s.displacement.x), csv_number(s.displacement.y), csv_number(s.u.x),
                        csv_number(s.u.y), word_for(s.status), device, frame.host_ns, frame.utc_ns);
  }
  return text;
}

}  // namespace

// Earlier segments in the folder.
struct LiveStore::Found {
  std::vector<long> finished, unfinished;
};

LiveStore::LiveStore(LiveStoreOptions options, RunStart start, MeasureOptions measure, EndOf end)
    : options_(std::move(options)),
      start_(std::move(start)),
      measure_(std::move(measure)),
      end_(std::move(end)),
      tasks_(std::make_unique<TaskQueue>()) {}

tl::expected<ObservationLog, RunFailure> LiveStore::open() {
  return options_.has_segments() ? open_segments() : open_single();
}

tl::expected<ObservationLog, RunFailure> LiveStore::open_single() {
  const RunPlace place = place_of_run(options_.folder);
  if (options_.earlier == Earlier::kResume) overlay_ = bytes_of(place.unfinished / "overlay.png");
  current_ = std::make_unique<LiveSegment>(place, measure_);
  auto log = current_->open(start_, options_.earlier);
  if (!log) return Failed(failure_of(log.error()));
  if (log->reference) continue_from(*log);
  if (log->reference) current_->show(overlay_);
  return *std::move(log);
}

std::string LiveStore::folder_of(long number) const {
  return fmt::format("{}/{}{:06}", options_.folder, kPrefix, number);
}

tl::expected<LiveStore::Segment, OutputError> LiveStore::new_segment(long number) {
  auto segment = std::make_unique<LiveSegment>(place_of_run(folder_of(number)), measure_);
  auto log = segment->open(start_, Earlier::kAsk);
  if (!log) return tl::unexpected(log.error());
  return segment;
}

tl::expected<LiveStore::Found, RunFailure> LiveStore::earlier_segments() {
  std::error_code error;
  const fs::path folder = options_.folder;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    return unusable_folder(fmt::format(
        "the output folder cannot be used: {} (it is not a folder): choose another with -o", options_.folder));
  fs::create_directories(folder, error);
  if (error)
    return Failed(RunFailure{Exit::kOutputUnwritable,
                             fmt::format("the output folder cannot be made: {} ({}): choose another with -o",
                                         options_.folder, error.message())});
  Found found{segments_in(folder, false), segments_in(folder, true)};
  const bool has_segments = !found.finished.empty() || !found.unfinished.empty();
  if (!has_segments && !fs::is_empty(folder, error))
    return unusable_folder(fmt::format(
        "the output folder cannot be used: {} (it holds other files): choose another with -o", options_.folder));
  if (has_segments && options_.earlier != Earlier::kResume)
    return unusable_folder(
        fmt::format("the output folder holds segments: {}: continue them with --resume, or choose another with -o",
                    options_.folder));
  return found;
}

// Opens a segment that was not finished, and adds it to `kept_segments`. Returns its observations.
tl::expected<ObservationLog, RunFailure> LiveStore::take_kept(long number, std::vector<Ended>& kept_segments) {
  const RunPlace place = place_of_run(folder_of(number));
  MeasureOptions options = measure_;
  const auto kept = recover_run((place.unfinished / kRunFileName).string());
  if (kept && kept->run.options.method != nullptr) options.reference_frame = kept->run.options.reference_frame;
  std::vector<std::uint8_t> overlay = bytes_of(place.unfinished / "overlay.png");
  auto segment = std::make_unique<LiveSegment>(place, options);
  auto log = segment->open(start_, Earlier::kResume);
  if (!log) return Failed(failure_of(log.error()));
  if (!log->reference || log->observations.empty()) return ObservationLog{};
  if (!overlay.empty()) overlay_ = std::move(overlay);
  SegmentEnd end = end_();
  end.log.input = log->input;
  kept_segments.emplace_back(std::move(segment), std::move(end));
  return *std::move(log);
}

tl::expected<ObservationLog, RunFailure> LiveStore::take_finished(long number) const {
  const std::string path = (fs::path(folder_of(number)) / kRunFileName).string();
  auto stored = read_run(path);
  if (!stored) return Failed(RunFailure{Exit::kInputUnreadable, stored.error()});
  MeasureOptions options = measure_;
  options.reference_frame = stored->options.reference_frame;
  if (const auto differs = difference(*stored, start_, options))
    return unusable_folder(
        fmt::format("the segments had other options: {} ({}): repeat those options, or choose another folder with -o",
                    options_.folder, *differs));
  return std::move(stored->seen);
}

void LiveStore::continue_from(const ObservationLog& log) {
  reference_ = std::make_shared<const Reference>(*log.reference);
  notes_ = log.notes;
  start_.input.start_utc = log.input.start_utc;
  if (!options_.has_segments()) return;
  measure_.reference_frame = reference_->seen.frame;
  const double time_s = log.observations.empty() ? kNotMeasured : log.observations.back().time_s;
  index_ = std::isnan(time_s) ? 0 : static_cast<long>(std::floor(time_s / options_.segment_s));
}

tl::expected<ObservationLog, RunFailure> LiveStore::open_segments() {
  const auto found = earlier_segments();
  if (!found) return Failed(found.error());
  ObservationLog last;
  std::vector<Ended> kept;
  number_ = found->finished.empty() ? 0 : found->finished.back();
  for (const long number : found->unfinished) {
    auto log = take_kept(number, kept);
    if (!log) return log;
    if (!log->reference) continue;  // it had no frames, and its folder was removed
    last = *std::move(log);
    number_ = std::max(number_, number);
  }
  if (!last.reference && !found->finished.empty()) {
    auto log = take_finished(found->finished.back());
    if (!log) return log;
    last = *std::move(log);
    overlay_ = bytes_of(fs::path(folder_of(found->finished.back())) / "overlay.png");
  }
  if (last.reference) continue_from(last);
  // Not earlier: their tasks read the overlay, which each of them may bring.
  for (auto& [segment, end] : kept) finish_later(std::move(segment), std::move(end));
  auto segment = new_segment(++number_);
  if (!segment) return Failed(failure_of(segment.error()));
  current_ = *std::move(segment);
  if (reference_) current_->journal().refer(*reference_, notes_);
  prepare_next();
  return last;
}

// The next segment is opened in advance, because that waits for the disk.
void LiveStore::prepare_next() {
  if (!reference_ || !options_.has_segments()) return;
  tasks_->add([this, number = number_ + 1] {
    auto segment = new_segment(number);
    if (!segment) return;  // the present segment becomes longer
    (*segment)->show(overlay_);
    (*segment)->journal().refer(*reference_, notes_);
    const std::lock_guard lock(mutex_);
    next_ = *std::move(segment);
  });
}

LiveStore::Segment LiveStore::take_next() {
  if (options_.may_wait) tasks_->wait();
  const std::lock_guard lock(mutex_);
  return std::move(next_);
}

void LiveStore::begin_frame(double time_s) {
  if (!options_.has_segments() || !reference_ || std::isnan(time_s)) return;
  const long index = static_cast<long>(std::floor(time_s / options_.segment_s));
  if (index <= index_ || frames_ == 0 || (!options_.may_wait && tasks_->pending() >= kMaxPending)) return;
  Segment next = take_next();
  if (!next) return;
  index_ = index;
  finish_later(std::exchange(current_, std::move(next)), end_());
  ++number_;
  frames_ = 0;
  prepare_next();
}

void LiveStore::finish_later(Segment segment, SegmentEnd end) {
  const auto shared = std::make_shared<Ended>(std::move(segment), std::move(end));
  tasks_->add([this, shared] {
    complete(*shared->first, shared->second);
    (void)::malloc_trim(0);  // the solver's memory would stay in the heap for days
    delete_old();
  });
}

void LiveStore::complete(LiveSegment& segment, const SegmentEnd& end) {
  SegmentEnd with_overlay = end;
  with_overlay.overlay = [&](const Measurement& measured) {
    return overlay_.empty() && end.overlay ? end.overlay(measured) : overlay_;
  };
  auto done = segment.finish(with_overlay);
  if (!done) {
    stored_.trouble = done.error();
    return;
  }
  for (const TargetSummary& target : done->measurement.targets) {
    stored_.rows += target.frames;
    stored_.ok_rows += target.ok;
  }
  if (options_.has_segments())
    stored_.segments.push_back(done->folder);
  else
    stored_.run = *std::move(done);
}

// Deletes the oldest finished segments beyond --keep and --quota. The newest one stays.
void LiveStore::delete_old() const {
  const fs::path folder = options_.folder;
  std::vector<long> finished = segments_in(folder, false);
  std::uint64_t size = size_of(folder);
  for (std::size_t k = 0; k + 1 < finished.size(); ++k) {
    const fs::path oldest = folder_of(finished[k]);
    if (age_s(oldest) <= options_.keep_s && size <= options_.quota) return;
    size -= std::min(size, size_of(oldest));
    std::error_code error;
    fs::remove_all(oldest, error);
  }
}

void LiveStore::show_reference(const Measurement& log) {
  if (log.picture.grey.width() == 0) return;
  const auto shown = std::make_shared<Measurement>();
  shown->reference = log.reference;
  shown->picture = log.picture;
  tasks_->add([this, shown, place = current_->place()] {
    overlay_ = run_overlay(*shown, measure_);
    const std::string_view bytes{reinterpret_cast<const char*>(overlay_.data()), overlay_.size()};
    (void)write_file_atomically((place.unfinished / "overlay.png").string(), bytes);
  });
  prepare_next();
}

LiveStored LiveStore::finish_all(SegmentEnd end) {
  {
    const std::lock_guard lock(mutex_);
    next_.reset();
  }
  finish_later(std::move(current_), std::move(end));
  tasks_->wait();
  next_.reset();  // prepared meanwhile; its empty folder is removed
  return std::move(stored_);
}

void LiveStore::refer(const Reference& reference, const std::vector<std::string>& notes) {
  current_->journal().refer(reference, notes);
  reference_ = std::make_shared<const Reference>(reference);
  notes_ = notes;
  if (options_.has_segments()) measure_.reference_frame = reference.seen.frame;
}

void LiveStore::add(const std::string& packed) {
  ++frames_;
  current_->journal().add(packed);
}

void LiveStore::start(const LiveRun& run) { names_ = std::make_shared<const std::vector<std::string>>(run.markers); }

void LiveStore::put(const PublishedFrame& frame) {
  if (frame.rows.empty()) return;
  if (!current_->can_put()) lost_rows_ += static_cast<long>(frame.rows.size());
  const auto shared = std::make_shared<const PublishedFrame>(frame);
  current_->put([names = names_, shared] { return rows_text(*names, *shared); });
}

}  // namespace moiregauge::internal
