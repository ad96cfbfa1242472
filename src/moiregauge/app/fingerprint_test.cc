// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/fingerprint.h"

#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kBytes = 4 << 20;  // reading them takes longer than the test needs to call hex()

InputOptions with_threads(int threads) {
  InputOptions options;
  options.threads = threads;
  return options;
}

TEST(Fingerprint, IsTheSameDuringAMeasurementAsBeforeIt) {
  const TestFolder folder;
  put_text(folder / "video.avi", std::string(kBytes, 'x'));
  Fingerprint concurrent(folder / "video.avi", with_threads(4));
  Fingerprint before(folder / "video.avi", with_threads(1));
  EXPECT_EQ(concurrent.hex(), before.hex());
  EXPECT_EQ(concurrent.hex().size(), 64U);
}

TEST(Fingerprint, WhoGivesUpDoesNotWaitForIt) {
  const TestFolder folder;
  put_text(folder / "video.avi", std::string(kBytes, 'x'));
  for (int k = 0; k < 20; ++k) Fingerprint(folder / "video.avi", with_threads(4));
}

}  // namespace
}  // namespace moiregauge::internal
