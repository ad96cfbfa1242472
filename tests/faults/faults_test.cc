// SPDX-License-Identifier: Apache-2.0
// A fixed part of the fault corpus, with one or two recordings of every mode. A fault must not lead to a wrong row that
// is `ok`. A clean recording must have only rows that are `ok`. The whole corpus is measured by tools/fault-study
// (docs/accuracy.md).
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "faults/fault_run.h"

namespace moiregauge::internal::faults {
namespace {

// Returns all modes but those with a wrong statement that images need not contradict.
std::vector<std::size_t> to_identify() {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < modes().size(); ++i) {
    if (!modes()[i].stated_by_site) out.push_back(i);
  }
  return out;
}

class EveryMode : public testing::TestWithParam<std::size_t> {};

TEST_P(EveryMode, HasNoSilentLie) {
  const Mode& mode = modes()[GetParam()];
  // Use the middle strength, and a seed for each mode: layouts, lenses and cameras then differ from mode to mode.
  const std::size_t strength = mode.strengths.size() / 2;
  const int seed = static_cast<int>(GetParam()) + 40;
  const Verdict verdict = verdict_on(sequence_of(mode, strength, seed), testing::TempDir());
  EXPECT_GT(verdict.rows, 0);
  EXPECT_EQ(verdict.lies, 0) << mode.strengths[strength].words << ", seed " << seed << ": an error of "
                             << verdict.worst_u << " u, " << verdict.worst_um << " um in a row called ok";
  if (mode.clean) {
    EXPECT_EQ(verdict.ok, verdict.rows) << testing::PrintToString(verdict.statuses) << verdict.refusal;
  }
}

// A reference 15 or 30 mm in front of or behind the plane looks 1 or 2 % larger or smaller. A solution with gratings of
// another size would have f up to 35 % wrong, and rows `ok` with errors up to 10 u.
TEST(FaultsFound, AReferenceOffThePlaneIsNotAPrintOfAnotherSize) {
  const auto mode =
      std::find_if(modes().begin(), modes().end(), [](const Mode& m) { return m.name == "reference off the plane"; });
  ASSERT_NE(mode, modes().end());
  for (std::size_t strength = 0; strength < mode->strengths.size(); ++strength) {
    const Verdict verdict = verdict_on(sequence_of(*mode, strength, 7), testing::TempDir());
    EXPECT_EQ(verdict.ok, verdict.rows) << testing::PrintToString(verdict.statuses) << verdict.refusal;
    EXPECT_EQ(verdict.lies, 0) << mode->strengths[strength].words << ": an error of " << verdict.worst_u << " u, "
                               << verdict.worst_um << " um in a row called ok";
  }
}

INSTANTIATE_TEST_SUITE_P(Corpus, EveryMode, testing::ValuesIn(to_identify()), [](const auto& param) {
  std::string name = modes()[param.param].name;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name;
});

}  // namespace
}  // namespace moiregauge::internal::faults
