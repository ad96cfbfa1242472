// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/unfinished_run.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/io/journal/run_identity.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

tl::unexpected<OutputError> usage(std::string message) { return tl::unexpected(OutputError{true, std::move(message)}); }

// Returns the number of frames that can be resumed: 0 without a reference frame, because nothing was measured yet.
long frames_of(const KeptRun& kept) {
  return kept.run.seen.reference ? static_cast<long>(kept.run.seen.observations.size()) : 0;
}

// Returns true and closes the file if another process has locked or replaced it. Otherwise takes the lock. On file
// systems without locks no process is detected.
bool is_anothers(int file, const std::string& path) {
  const bool is_locked = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  struct ::stat opened {};
  struct ::stat there {};
  const bool is_there =
      ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &there) == 0 && opened.st_ino == there.st_ino;
  if (!is_locked && is_there) return false;
  ::close(file);
  return true;
}

bool is_ours(const fs::path& folder) {
  std::error_code error;
  return fs::is_empty(folder, error) || fs::exists(folder / kRunFileName, error) ||
         fs::exists(folder / "run.json", error);
}

}  // namespace

bool is_measured_elsewhere(const RunPlace& place) {
  const int file = ::open((place.unfinished / kRunFileName).c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return false;
  const bool is_locked = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(file);  // also releases the lock
  return is_locked;
}

UnfinishedRun::~UnfinishedRun() {
  journal_.reset();  // writes pending records
  if (file_ < 0) return;
  std::error_code error;
  if (frames_ == 0 && !is_whole_) fs::remove_all(place_.unfinished, error);
  ::close(file_);  // also releases the lock
}

OutputError UnfinishedRun::unwritable(const std::string& why) const {
  const long safe = journal_ ? journal_->frames_safe() : frames_;
  const std::string file = fmt::format("{}.unfinished/{}", place_.shown, kRunFileName);
  if (safe == 0)
    return {false, fmt::format("the results could not be written: {} ({}): free space or choose another folder with -o",
                               file, why)};
  return {false,
          fmt::format(
              "the results could not be written: {} ({}; {} frames are kept): free space and run again with --resume",
              file, why, safe)};
}

std::string UnfinishedRun::in_use() const {
  return fmt::format("{}: {}.unfinished: wait for it, or choose another with -o", kRunInUse, place_.shown);
}

tl::expected<std::optional<UnfinishedRun::Found>, OutputError> UnfinishedRun::find() {
  std::error_code error;
  Found found;
  fs::path path = journal_path();
  if (!fs::exists(path, error)) {
    if (fs::exists(place_.unfinished, error) && !is_ours(place_.unfinished))
      return usage(fmt::format(
          "the folder of the unfinished run holds other files: {}.unfinished: choose another with -o", place_.shown));
    path = place_.results / kRunFileName;
    found.in_results = holds_interrupted_run(place_.results) && fs::exists(path, error);
    if (!found.in_results) return std::nullopt;
  }
  found.file = ::open(path.c_str(), O_RDWR | O_APPEND | O_CLOEXEC);
  if (found.file < 0) return tl::unexpected(unwritable(std::strerror(errno)));
  if (is_anothers(found.file, path.string())) return usage(in_use());
  found.kept = recover_run(path.string());
  return found;
}

tl::expected<void, OutputError> UnfinishedRun::judge(const Found& found, const RunStart& start,
                                                     const MeasureOptions& options, Earlier earlier) const {
  const std::string where = place_.shown + (found.in_results ? "" : ".unfinished");
  if (!found.kept) {
    if (earlier == Earlier::kRestart) return {};
    return usage(fmt::format("the unfinished run cannot be resumed: {} ({}): start again with --restart", where,
                             found.kept.error()));
  }
  const RunStart& then = found.kept->run.start;
  const long frames = frames_of(*found.kept);
  if (then.fingerprint != start.fingerprint)
    return usage(fmt::format(
        "the folder holds an unfinished run of another input: {} ({} frames of {}): choose another with -o, or "
        "remove it",
        where, frames, then.input.path));
  if (earlier == Earlier::kAsk)
    return usage(fmt::format(
        "there is an unfinished run: {} ({} frames): continue it with --resume, or start again with --restart", where,
        frames));
  if (earlier == Earlier::kRestart) return {};
  if (!found.kept->is_of_this_version)
    return usage(fmt::format("another version of moiregauge started this run: {}: start again with --restart", where));
  if (const auto differs = difference(found.kept->run, start, options))
    return usage(fmt::format(
        "the unfinished run had other options: {} ({}): repeat those options, or start again with --restart", where,
        *differs));
  return {};
}

tl::expected<ObservationLog, OutputError> UnfinishedRun::begin(const RunStart& start, const MeasureOptions& options,
                                                               Earlier earlier) {
  recover(place_);
  auto found = find();
  if (!found) return tl::unexpected(found.error());
  if (!*found) return start_new(start, options, -1);
  // A run killed before the first measurement needs no decision.
  if (!(*found)->kept || frames_of(*(*found)->kept) > 0) {
    if (const auto allowed = judge(**found, start, options, earlier); !allowed) {
      ::close((*found)->file);
      return tl::unexpected(allowed.error());
    }
    if (earlier == Earlier::kResume) return may_continue(std::move(**found));
  }
  if (!(*found)->in_results) return start_new(start, options, (*found)->file);
  ::close((*found)->file);
  return start_new(start, options, -1);
}

tl::expected<ObservationLog, OutputError> UnfinishedRun::start_new(const RunStart& start, const MeasureOptions& options,
                                                                   int locked) {
  const auto failed = [&] { return tl::unexpected(unwritable(std::strerror(errno))); };
  std::error_code error;
  fs::create_directories(place_.unfinished, error);
  if (error) return tl::unexpected(unwritable(error.message()));
  if (locked < 0) {
    locked = ::open(journal_path().c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (locked < 0) {
      const auto why = failed();
      fs::remove(place_.unfinished, error);
      return why;
    }
    if (is_anothers(locked, journal_path())) return usage(in_use());
  }
  file_ = locked;
  keep_journal_only(place_.unfinished);
  fs::remove(place_.unfinished / kLiveRowsName, error);
  if (::ftruncate(file_, 0) != 0) return failed();
  journal_ = std::make_unique<JournalFile>(file_, 0, 0);
  // Sync the head and the folder names now: from here on every sync of the file makes its frames safe.
  if (const auto done = journal_->append(head_bytes(start, options)); !done)
    return tl::unexpected(unwritable(done.error()));
  if (!sync_folder(place_.unfinished.string()) || !sync_folder(place_.unfinished.parent_path().string()))
    return failed();
  journal_->start();
  return ObservationLog{};
}

tl::expected<ObservationLog, OutputError> UnfinishedRun::may_continue(Found found) {
  const auto failed = [&] { return tl::unexpected(unwritable(std::strerror(errno))); };
  file_ = found.file;
  frames_ = frames_of(*found.kept);
  if (found.in_results) {
    std::error_code error;
    fs::remove_all(place_.unfinished, error);
    if (std::rename(place_.results.c_str(), place_.unfinished.c_str()) != 0) return failed();
    if (!sync_folder(place_.unfinished.parent_path().string())) return failed();
  }
  if (::ftruncate(file_, static_cast<off_t>(found.kept->bytes)) != 0) return failed();
  keep_journal_only(place_.unfinished);
  journal_ = std::make_unique<JournalFile>(file_, found.kept->bytes, frames_);
  journal_->start();
  return std::move(found.kept->run.seen);
}

void UnfinishedRun::refer(const Reference& reference, const std::vector<std::string>& notes) {
  journal_->add([reference, notes] { return reference_bytes(reference, notes); }, false);
}

void UnfinishedRun::add(const std::string& packed) {
  ++frames_;
  journal_->add([packed] { return frame_bytes(packed); }, true);
}

tl::expected<void, OutputError> UnfinishedRun::close() {
  if (const auto done = journal_->finish(); !done) return tl::unexpected(unwritable(done.error()));
  return {};
}

tl::expected<void, OutputError> UnfinishedRun::end(const ObservationLog& seen, const MeasureOptions& options) {
  if (const auto done = journal_->append(end_bytes(seen, options)); !done)
    return tl::unexpected(unwritable(done.error()));
  is_whole_ = true;
  return {};
}

}  // namespace moiregauge::internal
