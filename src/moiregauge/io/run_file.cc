// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_file.h"

#include <filesystem>
#include <fstream>
#include <limits>

#include <fmt/format.h>

#include "moiregauge/io/crc32.h"
#include "moiregauge/io/run_layout.h"

namespace moiregauge {

// The last record: what is known only at the end.
struct RunEnd {
  InputInfo input;
  std::vector<std::string> notes;
  std::string refusal;
  bool input_damaged = false;
  bool interrupted = false;
  std::size_t observations = 0;
};
template <>
inline constexpr std::size_t kFields<RunEnd> = 6;

namespace {

// A first byte that is no text, line ends that a transfer as text would change.
constexpr std::string_view kMagic{"\x8dMGJ\r\n\x1a\n", 8};
constexpr std::size_t kWord = 4;  // bytes of a tag, a length, a check sum
constexpr std::string_view kOptionsTag = "OPTN", kReferenceTag = "REFR", kObservationTag = "OBSV", kEndTag = "LAST";

template <typename Value>
void spell(LayoutSpeller& speller) {
  Value value;
  store(speller, value);
}

std::string made_header() {
  LayoutSpeller speller;
  spell<MeasureOptions>(speller);
  spell<Reference>(speller);
  spell<Observation>(speller);
  spell<RunEnd>(speller);
  std::string bytes(kMagic);
  append_little_endian(bytes, kRunFileVersion, kWord);
  append_little_endian(bytes, crc32(speller.spelling()), kWord);
  return bytes;
}

const std::string& header() {
  static const std::string made = made_header();
  return made;
}

template <typename Value>
std::string record(std::string_view tag, const Value& value) {
  ByteWriter payload;
  store(payload, value);
  std::string bytes(tag);
  append_little_endian(bytes, payload.bytes().size(), kWord);
  bytes += payload.bytes();
  append_little_endian(bytes, crc32(bytes), kWord);
  return bytes;
}

using Problem = tl::unexpected<std::string>;

Problem damaged(const std::string& path, std::string_view why) {
  return Problem(fmt::format("damaged observations: {}: {}: measure the input again", path, why));
}

// Up to `size` bytes; fewer only where the file ends.
std::string bytes_of(std::istream& file, std::size_t size) {
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
  RecordReader(std::istream& file, const std::string& path) : file_(file), path_(path), left_(size_of(file)) {}

  tl::expected<void, std::string> begin() {
    const std::string& wanted = header();
    const std::string found = take(wanted.size());
    if (found.substr(0, kMagic.size()) != kMagic.substr(0, found.size()) || found.empty())
      return Problem(fmt::format("no observations: {}: it is not a file of moiregauge: give a run's folder", path_));
    if (found.size() < wanted.size()) return damaged(path_, "it breaks off");
    if (found != wanted)
      return Problem(
          fmt::format("observations of another version of moiregauge: {}: solve with the version that "
                      "measured (run.json names it), or measure the input again",
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
      return damaged(path_, "a check sum is wrong");
    return record;
  }
  [[nodiscard]] bool is_finished() const { return left_ == 0; }

 private:
  tl::expected<Record, std::string> breaks_off() const { return damaged(path_, "it breaks off"); }
  std::string take(std::size_t size) {
    std::string bytes = bytes_of(file_, std::min(size, left_));
    left_ -= bytes.size();
    return bytes;
  }
  std::istream& file_;
  const std::string& path_;
  std::size_t left_;
};

template <typename Value>
bool read_whole(const std::string& payload, Value& value) {
  ByteReader reader(payload);
  store(reader, value);
  return reader.is_finished();
}

// What the solvers take for granted and a check sum cannot know.
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

bool is_sound(const StoredRun& run) {
  if (run.options.method == nullptr || !is_sound(run.options.site)) return false;
  if (!run.seen.reference) return true;
  for (const Observation& seen : run.seen.observations) {
    if (!fits(run.seen.reference->site, seen)) return false;
  }
  return is_sound(*run.seen.reference);
}

// Takes one record in; false where it cannot be.
bool take_in(const Record& record, StoredRun& run, std::optional<RunEnd>& end) {
  if (record.tag == kOptionsTag) return read_whole(record.payload, run.options);
  if (record.tag == kReferenceTag) return read_whole(record.payload, run.seen.reference.emplace());
  if (record.tag == kObservationTag) return read_whole(record.payload, run.seen.observations.emplace_back());
  return record.tag == kEndTag && read_whole(record.payload, end.emplace());
}

}  // namespace

bool write_run(const Seen& seen, const MeasureOptions& options, const PutBytes& put) {
  bool wrote = put(header()) && put(record(kOptionsTag, options));
  if (seen.reference) wrote = wrote && put(record(kReferenceTag, *seen.reference));
  for (std::size_t n = 0; wrote && n < seen.observations.size(); ++n)
    wrote = put(record(kObservationTag, seen.observations[n]));
  const RunEnd end{seen.input,         seen.notes,       seen.refusal,
                   seen.input_damaged, seen.interrupted, seen.observations.size()};
  return wrote && put(record(kEndTag, end));
}

tl::expected<StoredRun, std::string> parse_run(std::istream& file, const std::string& path) {
  RecordReader records(file, path);
  if (const auto begun = records.begin(); !begun) return Problem(begun.error());
  StoredRun run;
  std::optional<RunEnd> end;
  while (!end) {
    const auto record = records.next();
    if (!record) return Problem(record.error());
    if (!take_in(*record, run, end)) return damaged(path, "a record makes no sense");
  }
  if (!records.is_finished()) return damaged(path, "something follows its last record");
  if (end->observations != run.seen.observations.size()) return damaged(path, "frames are missing");
  run.seen.input = std::move(end->input);
  run.seen.notes = std::move(end->notes);
  run.seen.refusal = std::move(end->refusal);
  run.seen.input_damaged = end->input_damaged;
  run.seen.interrupted = end->interrupted;
  if (!is_sound(run)) return damaged(path, "its parts do not fit together");
  return run;
}

tl::expected<StoredRun, std::string> read_run(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return Problem(
        fmt::format("no observations: {}: there is no such file: give the folder of a run of `measure`", path));
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path, ignored))
    return Problem(fmt::format("no observations: {}: it cannot be read: check its permissions", path));
  return parse_run(file, path);
}

}  // namespace moiregauge
