// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/journal/run_file.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/base/crc32.h"
#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/io/journal/run_layout.h"

namespace moiregauge::internal {
namespace {

// An archive that "reads" made-up values: all real numbers, texts and frame numbers differ. Lists have `count`
// elements, and optional values are present.
class Filler {
 public:
  static constexpr bool kReads = true;
  explicit Filler(std::size_t count) : count_(count) {}
  template <typename Number>
  void number(Number& value) {
    value = std::is_same_v<Number, int> ? Number(1) : static_cast<Number>(++last_);
    if constexpr (std::is_same_v<Number, double>) value += 1.0 / 3.0;
  }
  [[nodiscard]] static bool flag(bool) { return true; }
  [[nodiscard]] std::size_t count(std::size_t) const { return count_; }
  void text(std::string& value) { value = "text " + std::to_string(++last_); }
  [[nodiscard]] static bool good() { return true; }
  void fail() {}
  void open() {}
  void close() {}

 private:
  std::size_t count_;
  long last_ = 0;
};

StoredRun filled_run(std::size_t count) {
  StoredRun run;
  Filler filler(count);
  run.start = {"0.1.0", "2 files", 10.0 / 3.0, true, {}};
  store(filler, run.start.input);
  store(filler, run.options);
  run.options.method = method_named("precise");
  store(filler, run.seen.input);
  store(filler, run.seen.notes);
  store(filler, run.seen.refusal);
  std::vector<Observation> observations;
  store(filler, observations);
  store(filler, run.seen.reference);
  for (CirclePoint& point : run.seen.reference->circles) point.marker = count - 1;
  const NormalMatrix normal = NormalVector::LinSpaced(1.0 / 3.0, 2.0).asDiagonal();
  for (auto& print : run.seen.reference->prints) {
    print->print = PrintTemplate::cosine(1.0 / 7.0, 2.0 / 7.0);
    print->at_rest->system = *PatchSystem::of(normal, 77, {.along_y = false});
  }
  run.seen.observations.refer_to(*run.seen.reference);
  for (const Observation& seen : observations) run.seen.observations.push_back(seen);
  run.seen.input_damaged = run.seen.interrupted = true;
  return run;
}

std::string bytes_of(const StoredRun& run) {
  std::string bytes = head_bytes(run.start, run.options);
  if (run.seen.reference) bytes += reference_bytes(*run.seen.reference, run.seen.notes);
  for (std::size_t n = 0; n < run.seen.observations.size(); ++n) bytes += frame_bytes(run.seen.observations.packed(n));
  return bytes + end_bytes(run.seen, run.options);
}

tl::expected<StoredRun, std::string> parsed(const std::string& bytes) {
  std::istringstream file(bytes);
  return parse_run(file, "here/run.mgj");
}

tl::expected<KeptRun, std::string> kept_of(const std::string& bytes) {
  std::istringstream file(bytes);
  return parse_kept_run(file, "here/run.mgj");
}

TEST(Crc32, IsThatOfPng) { EXPECT_EQ(crc32("123456789"), 0xCBF43926U); }

TEST(RunFile, RestoresEveryFieldToTheLastBit) {
  const StoredRun run = filled_run(2);
  const std::string bytes = bytes_of(run);
  const auto again = parsed(bytes);
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(bytes_of(*again), bytes);
  // The writer and reader could omit the same field, so compare some fields directly.
  EXPECT_EQ(again->options.method, run.options.method);
  EXPECT_EQ(again->options.reference_frame, run.options.reference_frame);
  EXPECT_EQ(again->seen.input.warnings, run.seen.input.warnings);
  EXPECT_EQ(again->seen.observations[1].markers[1].points->information,
            run.seen.observations[1].markers[1].points->information);
  EXPECT_EQ(again->seen.observations[1].markers[0].patch.gradient, run.seen.observations[1].markers[0].patch.gradient);
  EXPECT_EQ(again->seen.reference->prints[1]->print.coefficient(0, 1),
            run.seen.reference->prints[1]->print.coefficient(0, 1));
  EXPECT_EQ(again->seen.reference->prints[1]->at_rest->system.information(5),
            run.seen.reference->prints[1]->at_rest->system.information(5));
  EXPECT_EQ(again->seen.reference->view.ideal_from_board.matrix(), run.seen.reference->view.ideal_from_board.matrix());
  EXPECT_TRUE(again->seen.interrupted);
}

TEST(RunFile, KeepsNanSignsAndAbsentValues) {
  StoredRun run = filled_run(1);
  Observation seen = run.seen.observations[0];
  seen.time_s = std::numeric_limits<double>::quiet_NaN();
  seen.markers[0].patch.u_gradient = -0.0;
  seen.markers[0].points.reset();
  run.seen.observations.replace(0, seen);
  const auto again = parsed(bytes_of(run));
  ASSERT_TRUE(again) << again.error();
  EXPECT_TRUE(std::isnan(again->seen.observations[0].time_s));
  EXPECT_TRUE(std::signbit(again->seen.observations[0].markers[0].patch.u_gradient));
  EXPECT_FALSE(again->seen.observations[0].markers[0].points.has_value());
}

TEST(RunFile, ARefusedRunHasNoReference) {
  StoredRun run = filled_run(1);
  run.seen.reference.reset();
  const auto again = parsed(bytes_of(run));
  ASSERT_TRUE(again) << again.error();
  EXPECT_FALSE(again->seen.reference.has_value());
  EXPECT_EQ(again->seen.refusal, run.seen.refusal);
}

TEST(RunFile, ATruncatedFileIsAnError) {
  const std::string whole = bytes_of(filled_run(1));
  for (std::size_t size = 0; size < whole.size(); size += 3) {
    const auto read = parsed(whole.substr(0, size));
    ASSERT_FALSE(read) << "the first " << size << " of " << whole.size() << " bytes";
    ASSERT_NE(read.error().find("here/run.mgj"), std::string::npos);
  }
  EXPECT_FALSE(parsed(whole + '\0'));
}

TEST(RunFile, FramesBeforeATruncationAreKept) {
  StoredRun run = filled_run(1);
  for (int k = 0; k < 2; ++k) run.seen.observations.push_back(run.seen.observations[0]);
  const std::string whole = bytes_of(run), end = end_bytes(run.seen, run.options),
                    frame = frame_bytes(run.seen.observations.packed(0));
  const std::size_t head = head_bytes(run.start, run.options).size();
  const std::size_t first = whole.size() - end.size() - 3 * frame.size();
  for (std::size_t size = 0; size <= whole.size(); size += size < head ? 1 : 7) {
    const auto kept = kept_of(whole.substr(0, size));
    ASSERT_TRUE(kept) << size << ": " << kept.error();
    ASSERT_EQ(kept->run.options.method == nullptr, size < head) << size;
    const std::size_t frames = size < first ? 0 : std::min<std::size_t>((size - first) / frame.size(), 3);
    ASSERT_EQ(kept->run.seen.observations.size(), frames) << size;
    ASSERT_EQ(kept->run.seen.reference.has_value(), size >= first) << size;
    ASSERT_EQ(kept->has_end, size == whole.size());
    ASSERT_LE(kept->bytes, size);
    if (size >= first) {
      ASSERT_EQ(kept->bytes, first + frames * frame.size());
      ASSERT_EQ(kept->run.seen.notes, run.seen.notes);
    }
  }
}

TEST(RunFile, FramesBeforeDamageAreKept) {
  StoredRun run = filled_run(1);
  for (int k = 0; k < 2; ++k) run.seen.observations.push_back(run.seen.observations[0]);
  std::string bytes = bytes_of(run);
  const std::size_t frame = frame_bytes(run.seen.observations.packed(0)).size();
  bytes[bytes.size() - end_bytes(run.seen, run.options).size() - frame / 2] ^= 1;  // in the last frame
  const auto kept = kept_of(bytes + "more");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->run.seen.observations.size(), 2U);
  EXPECT_FALSE(kept->has_end);
  bytes[20] ^= 1;  // in the head
  EXPECT_FALSE(kept_of(bytes));
  bytes[8] ^= 1;  // the version
  EXPECT_NE(kept_of(bytes).error().find("another version"), std::string::npos);
  EXPECT_FALSE(kept_of("frame,time_s,marker"));
}

// A site may be detected in the reference frame, so earlier frames do not know the number of markers.
TEST(RunFile, FramesMayPrecedeTheReferenceFrame) {
  const StoredRun run = filled_run(2);
  Observation before;
  const auto order = [&](const Observation& first) {
    ObservationLog seen = run.seen;
    seen.observations = {first, run.seen.observations[0]};
    return parsed(head_bytes(run.start, run.options) + frame_bytes(Observations().packed(first)) +
                  reference_bytes(*run.seen.reference, run.seen.notes) + frame_bytes(run.seen.observations.packed(0)) +
                  end_bytes(seen, run.options));
  };
  const auto read = order(before);
  ASSERT_TRUE(read) << read.error();
  EXPECT_TRUE(read->seen.observations[0].markers.empty());
  before.markers.resize(2);
  EXPECT_TRUE(order(before));
  before.markers.resize(1);
  EXPECT_FALSE(order(before));
}

TEST(RunFile, AnyChangedByteIsAnError) {
  std::string bytes = bytes_of(filled_run(1));
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const char was = bytes[at];
    bytes[at] = static_cast<char>(was ^ (1 << (at % 8)));
    ASSERT_FALSE(parsed(bytes)) << "byte " << at << " of " << bytes.size();
    bytes[at] = was;
  }
}

// Any bytes may have a correct check sum. They must be read or refused, without large allocations or invalid indices.
TEST(RunFile, ACorrectCheckSumIsNotTrusted) {
  const std::string whole = bytes_of(filled_run(1));
  constexpr std::size_t kHeader = 16;
  int refused = 0;
  for (std::size_t start = kHeader; start < whole.size();) {
    const std::size_t length = from_little_endian(std::string_view(whole).substr(start + 4, 4));
    const std::size_t end = start + 8 + length;
    for (std::size_t at = start; at < end; at += at < start + 8 ? 1 : 7) {
      if (at >= start + 4 && at < start + 8) continue;  // its length: tested above
      std::string bytes = whole;
      bytes[at] = static_cast<char>(0xff);
      std::string sum;
      append_little_endian(sum, crc32(std::string_view(bytes).substr(start, 8 + length)), 4);
      bytes.replace(end, 4, sum);
      if (!parsed(bytes)) ++refused;
    }
    start = end + 4;
  }
  EXPECT_GT(refused, 50);  // counts, flags, enumerations, method names, numbers of markers
}

TEST(RunFile, ReportsTheProblem) {
  const TestFolder place;
  EXPECT_NE(read_run(place / "run.mgj").error().find("does not exist"), std::string::npos);
  EXPECT_NE(read_run(place.path()).error().find("cannot be read"), std::string::npos);
  EXPECT_NE(parsed("frame,time_s,marker").error().find("no observations of moiregauge"), std::string::npos);
  std::string bytes = bytes_of(filled_run(1));
  EXPECT_NE(parsed(bytes.substr(0, bytes.size() - 1)).error().find("is incomplete"), std::string::npos);
  bytes[8] = 99;  // the version
  EXPECT_NE(parsed(bytes).error().find("another version"), std::string::npos);
}

TEST(RunFile, ARunWithInvalidOptionsIsRefused) {
  StoredRun run = filled_run(1);
  run.options.method = nullptr;
  const auto kept = kept_of(bytes_of(run));
  ASSERT_FALSE(kept.has_value());
  EXPECT_NE(kept.error().find("its header is invalid"), std::string::npos) << kept.error();
}

// Files written by the programs of those versions. Three frames of the small rig with cosine gratings and noise; the
// target moved by 0, 1 and 2 mm. The expected values are from displacement.csv of the same program.
struct EarlierRun {
  int version;
  double dx_mm[2], dy_mm[2];
};

class RunFileOfVersion : public testing::TestWithParam<EarlierRun> {};

TEST_P(RunFileOfVersion, IsReadAndSolved) {
  const EarlierRun& wanted = GetParam();
  auto run = read_run(fmt::format("{}/tests/data/run-version-{}.mgj", MOIREGAUGE_SOURCE_DIR, wanted.version));
  ASSERT_TRUE(run) << run.error();
  EXPECT_TRUE(run->seen.input.tone.curve.is_linear());
  ASSERT_TRUE(run->seen.reference);
  EXPECT_TRUE(run->seen.reference->light_per_grey.empty());
  // A cosine grating has no line width.
  for (const auto& print : run->seen.reference->prints) EXPECT_FALSE(print->options.has_width);
  // The information matrices of all frames are multiples of the reference frame's, so they pack well.
  ASSERT_EQ(run->seen.observations.size(), 3U);
  for (const std::size_t n : {1U, 2U}) EXPECT_LT(run->seen.observations.packed(n).size(), 2000U);
  Measurement solved;
  static_cast<ObservationLog&>(solved) = std::move(run->seen);
  evaluate(run->options, solved);
  ASSERT_EQ(solved.samples.size(), 3U);
  for (const std::size_t n : {1U, 2U}) {
    const Sample& sample = solved.samples[n];
    EXPECT_EQ(sample.status, Status::kOk);
    EXPECT_NEAR(sample.displacement.x, wanted.dx_mm[n - 1], 0.01 * sample.u.x);
    EXPECT_NEAR(sample.displacement.y, wanted.dy_mm[n - 1], 0.01 * sample.u.y);
  }
}

INSTANTIATE_TEST_SUITE_P(Earlier, RunFileOfVersion,
                         testing::Values(EarlierRun{2, {-0.001842, -0.004957}, {0.998911, 1.997619}},
                                         EarlierRun{3, {-0.001842, -0.004957}, {0.998911, 1.997619}},
                                         EarlierRun{4, {-0.002260, -0.003939}, {0.982917, 1.967867}}),
                         [](const auto& earlier) { return fmt::format("Version{}", earlier.param.version); });

TEST(RunFile, AnEarlierVersionCannotBeContinued) {
  std::ifstream file(fmt::format("{}/tests/data/run-version-3.mgj", MOIREGAUGE_SOURCE_DIR), std::ios::binary);
  const auto kept = parse_kept_run(file, "here/run.mgj");
  ASSERT_TRUE(kept) << kept.error();
  EXPECT_FALSE(kept->is_of_this_version);
  EXPECT_EQ(kept->run.seen.observations.size(), 3U);
  EXPECT_TRUE(kept_of(bytes_of(filled_run(1)))->is_of_this_version);
}

}  // namespace
}  // namespace moiregauge::internal
