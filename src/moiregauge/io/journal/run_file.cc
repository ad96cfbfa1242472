// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/journal/run_file.h"

#include <filesystem>
#include <fstream>
#include <limits>

#include <fmt/format.h>

#include "moiregauge/base/crc32.h"
#include "moiregauge/io/journal/deflate.h"
#include "moiregauge/io/journal/run_layout.h"

namespace moiregauge::internal {

// The last record: values known only at the end.
struct RunEnd {
  InputInfo input;
  std::vector<std::string> notes;
  std::string refusal;
  CameraProcessing processing;
  bool input_damaged = false;
  bool interrupted = false;
  std::size_t observations = 0;
};
template <>
inline constexpr std::size_t kFields<RunEnd> = 7;
template <>
inline constexpr std::array kAdded<RunEnd>{AddedFields{3, 1, 4}, AddedFields{}};
template <>
inline constexpr std::size_t kFields<RunStart> = 5;

namespace {

// The first byte is no text. A transfer in text mode would change the line ends and so be detected.
constexpr std::string_view kMagic{"\x8dMGJ\r\n\x1a\n", 8};
constexpr std::size_t kWord = 4;  // bytes of a tag, a length or a check sum
constexpr std::string_view kStartTag = "STRT", kOptionsTag = "OPTN", kReferenceTag = "REFR", kNotesTag = "NOTE",
                           kObservationTag = "OBSV", kEndTag = "LAST";

constexpr int kOldest = 2;
constexpr int kSincePacked = 4;  // since then frames are packed and deflated

template <typename Value>
void spell(LayoutSpeller& speller) {
  Value value;
  store(speller, value);
}

std::string made_header(int version) {
  LayoutSpeller speller(version);
  spell<RunStart>(speller);
  spell<MeasureOptions>(speller);
  spell<Reference>(speller);
  if (version >= kSincePacked)
    speller.word(kPackedLayout);
  else
    spell<Observation>(speller);
  spell<RunEnd>(speller);
  std::string bytes(kMagic);
  append_little_endian(bytes, static_cast<std::uint64_t>(version), kWord);
  append_little_endian(bytes, crc32(speller.spelling()), kWord);
  return bytes;
}

const std::string& header() {
  static const std::string made = made_header(kRunFileVersion);
  return made;
}

std::string record_of(std::string_view tag, const std::string& payload) {
  std::string bytes(tag);
  append_little_endian(bytes, payload.size(), kWord);
  bytes += payload;
  append_little_endian(bytes, crc32(bytes), kWord);
  return bytes;
}

template <typename Value>
std::string record(std::string_view tag, const Value& value) {
  ByteWriter payload;
  store(payload, value);
  return record_of(tag, payload.bytes());
}

using Problem = tl::unexpected<std::string>;

Problem damaged(const std::string& path, std::string_view why) {
  return Problem(fmt::format("the observations are damaged: {} ({}): measure the input again", path, why));
}

// Returns `size` bytes, or fewer at the end of the file.
std::string bytes_from(std::istream& file, std::size_t size) {
  std::string bytes(size, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

std::size_t size_of(std::istream& file) {
  file.seekg(0, std::ios::end);
  const auto size = file.tellg();
  file.seekg(0);
  return size < 0 ? 0 : static_cast<std::size_t>(size);
}

struct Record {
  std::string tag;
  std::string payload;
};

class RecordReader {
 public:
  RecordReader(std::istream& file, const std::string& path)
      : file_(file), path_(path), size_(size_of(file)), left_(size_) {}

  tl::expected<void, std::string> begin() {
    const std::string& wanted = header();
    const std::string found = take(wanted.size());
    is_cut_short_ = found.size() < wanted.size() && wanted.compare(0, found.size(), found) == 0;
    if (found.substr(0, kMagic.size()) != kMagic.substr(0, found.size()) || found.empty())
      return Problem(fmt::format("the file holds no observations of moiregauge: {}: give the folder of a run", path_));
    if (found.size() < wanted.size()) return damaged(path_, "it is incomplete");
    for (version_ = kRunFileVersion; version_ >= kOldest && found != made_header(version_);) --version_;
    if (version_ < kOldest)
      return Problem(
          fmt::format("another version of moiregauge wrote the observations: {}: use that version (run.json names it), "
                      "or measure the input again",
                      path_));
    return {};
  }
  tl::expected<Record, std::string> next() {
    const std::string head = take(2 * kWord);
    if (head.size() < 2 * kWord) return breaks_off();
    const auto length = static_cast<std::size_t>(from_little_endian(std::string_view(head).substr(kWord)));
    if (length > left_ || left_ - length < kWord) return breaks_off();
    Record record{head.substr(0, kWord), take(length)};
    if (crc32(record.payload, crc32(head)) != from_little_endian(take(kWord)))
      return damaged(path_, "a checksum is wrong");
    return record;
  }
  [[nodiscard]] int version() const { return version_; }
  [[nodiscard]] bool is_finished() const { return left_ == 0; }
  [[nodiscard]] bool is_cut_short() const { return is_cut_short_; }
  [[nodiscard]] std::size_t place() const { return size_ - left_; }  // offset of the next record

 private:
  tl::expected<Record, std::string> breaks_off() {
    is_cut_short_ = true;
    return damaged(path_, "it is incomplete");
  }
  std::string take(std::size_t size) {
    std::string bytes = bytes_from(file_, std::min(size, left_));
    left_ -= bytes.size();
    return bytes;
  }
  std::istream& file_;
  const std::string& path_;
  std::size_t size_;
  std::size_t left_;
  int version_ = kRunFileVersion;
  bool is_cut_short_ = false;
};

template <typename Value>
bool read_whole(const std::string& payload, int version, Value& value) {
  ByteReader reader(payload, version);
  store(reader, value);
  return reader.is_finished();
}

// Conditions that the solvers rely on and that a check sum cannot prove.
bool fits(const Site& site, const Observation& seen) { return seen.markers.size() == site.markers.size(); }

bool is_sound(const Site& site) {
  for (const Marker& m : site.markers) {
    if (!m.circle && !m.grating) return false;
  }
  return true;
}

bool is_sound(const Reference& reference) {
  const std::size_t markers = reference.site.markers.size();
  for (const CirclePoint& p : reference.circles) {
    if (p.marker >= markers || !reference.site.markers[p.marker].circle) return false;
  }
  return is_sound(reference.site) && fits(reference.site, reference.seen) && reference.plans.size() == markers &&
         reference.plan_loss.size() == markers && (reference.prints.empty() || reference.prints.size() == markers);
}

// Assembles a run from its records.
class RunReader {
 public:
  explicit RunReader(int version) : version_(version) {}
  // Returns false if the record is invalid at this position or contradicts earlier ones. A rejected record changes
  // nothing, except that a rejected start record leaves the run without a head.
  bool take(const Record& record) {
    if (record.tag == kStartTag)
      return places_ == 0 && read_whole(record.payload, version_, run_.start) && count_place();
    if (record.tag == kOptionsTag && places_ == 1) return take_options(record.payload) && count_place();
    if (places_ < 2 || end_) return false;
    if (record.tag == kOptionsTag) return take_options(record.payload);
    if (record.tag == kReferenceTag) return take_reference(record.payload);
    if (record.tag == kNotesTag) return take_notes(record.payload);
    if (record.tag == kObservationTag) return take_frame(record.payload);
    return record.tag == kEndTag && take_end(record.payload);
  }
  [[nodiscard]] bool has_head() const { return places_ == 2; }
  [[nodiscard]] bool has_end() const { return end_.has_value(); }
  // Returns the run. An unfinished run has the input information of its start.
  [[nodiscard]] StoredRun take_run() {
    ObservationLog& seen = run_.seen;
    if (end_) {
      seen.input = std::move(end_->input);
      seen.notes = std::move(end_->notes);
      seen.refusal = std::move(end_->refusal);
      seen.processing = end_->processing;
      seen.input_damaged = end_->input_damaged;
      seen.interrupted = end_->interrupted;
    } else {
      seen.input = run_.start.input;
      seen.interrupted = true;
    }
    return std::move(run_);
  }

 private:
  bool count_place() { return ++places_ > 0; }
  // Reads options, which are repeated with a statement of rest or zero. Invalid ones leave the first ones unchanged.
  bool take_options(const std::string& payload) {
    MeasureOptions options;
    if (!read_whole(payload, version_, options) || options.method == nullptr || !is_sound(options.site)) return false;
    run_.options = std::move(options);
    return true;
  }
  bool take_reference(const std::string& payload) {
    Reference reference;
    if (run_.seen.reference || !read_whole(payload, version_, reference) || !is_sound(reference)) return false;
    // Earlier frames have the site's markers, or none if the site was detected in the reference frame.
    for (const Observation& seen : run_.seen.observations) {
      if (!seen.markers.empty() && !fits(reference.site, seen)) return false;
    }
    if (version_ < kSinceWidth) {
      for (auto& print : reference.prints) {
        if (print) print->options.has_width = false;
      }
    }
    run_.seen.observations.refer_to(reference);
    run_.seen.reference = std::move(reference);
    return true;
  }
  bool take_notes(const std::string& payload) {
    std::vector<std::string> notes;
    if (run_.seen.reference || !read_whole(payload, version_, notes)) return false;
    run_.seen.notes = std::move(notes);
    return true;
  }
  bool take_frame(const std::string& payload) {
    std::string packed;
    if (version_ >= kSincePacked) {
      auto inflated_bytes = inflated(payload);
      if (!inflated_bytes) return false;
      packed = *std::move(inflated_bytes);
    } else {
      Observation seen;
      if (!read_whole(payload, version_, seen)) return false;
      packed = run_.seen.observations.packed(seen);
    }
    const auto seen = run_.seen.observations.unpacked(packed);
    if (!seen || (run_.seen.reference && !fits(run_.seen.reference->site, *seen))) return false;
    run_.seen.observations.push_back_packed(std::move(packed));
    return true;
  }
  bool take_end(const std::string& payload) {
    RunEnd end;
    if (!read_whole(payload, version_, end) || end.observations != run_.seen.observations.size()) return false;
    end_ = std::move(end);
    return true;
  }
  int version_;
  StoredRun run_;
  std::optional<RunEnd> end_;
  int places_ = 0;  // number of head records read (start, options)
};

tl::expected<std::ifstream, std::string> opened_run(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return Problem(
        fmt::format("there are no observations: {} does not exist: give a folder that `measure` wrote", path));
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path, ignored))
    return Problem(fmt::format("the observations cannot be read: {}: check its permissions", path));
  return file;
}

}  // namespace

std::string head_bytes(const RunStart& start, MeasureOptions options) {
  options.solve.rest.reset();
  options.zero.reset();
  return header() + record(kStartTag, start) + record(kOptionsTag, options);
}

std::string reference_bytes(const Reference& reference, const std::vector<std::string>& notes) {
  return record(kNotesTag, notes) + record(kReferenceTag, reference);
}

std::string frame_bytes(const std::string& packed) { return record_of(kObservationTag, deflated(packed)); }

std::string end_bytes(const ObservationLog& seen, const MeasureOptions& options) {
  return (options.solve.rest || options.zero ? record(kOptionsTag, options) : std::string{}) +
         record(kEndTag, RunEnd{seen.input, seen.notes, seen.refusal, seen.processing, seen.input_damaged,
                                seen.interrupted, seen.observations.size()});
}

tl::expected<StoredRun, std::string> parse_run(std::istream& file, const std::string& path) {
  RecordReader records(file, path);
  if (const auto begun = records.begin(); !begun) return Problem(begun.error());
  RunReader run(records.version());
  while (!run.has_end()) {
    const auto record = records.next();
    if (!record) return Problem(record.error());
    if (!run.take(*record)) return damaged(path, "a record is invalid");
  }
  if (!records.is_finished()) return damaged(path, "there is data after its last record");
  return run.take_run();
}

tl::expected<KeptRun, std::string> parse_kept_run(std::istream& file, const std::string& path) {
  RecordReader records(file, path);
  if (const auto begun = records.begin(); !begun) {
    if (records.is_cut_short()) return KeptRun{};
    return Problem(begun.error());
  }
  RunReader run(records.version());
  KeptRun kept;
  kept.is_of_this_version = records.version() == kRunFileVersion;
  while (!run.has_end()) {
    const auto record = records.next();
    const bool belongs_to_end = record && record->tag == kOptionsTag && run.has_head();
    if (!record || !run.take(*record)) break;
    if (!run.has_end() && !belongs_to_end) kept.bytes = records.place();
  }
  if (!run.has_head()) {
    if (records.is_cut_short()) return KeptRun{};
    return damaged(path, "its header is invalid");
  }
  kept.has_end = run.has_end() && records.is_finished();
  kept.run = run.take_run();
  return kept;
}

tl::expected<StoredRun, std::string> read_run(const std::string& path) {
  auto file = opened_run(path);
  if (!file) return Problem(file.error());
  return parse_run(*file, path);
}

tl::expected<KeptRun, std::string> recover_run(const std::string& path) {
  auto file = opened_run(path);
  if (!file) return Problem(file.error());
  return parse_kept_run(*file, path);
}

}  // namespace moiregauge::internal
