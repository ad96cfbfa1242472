// SPDX-License-Identifier: Apache-2.0
// Input: any bytes as a TIFF file.
// Requires: up to four pages, read in order, and the first page again, are images or errors.
#include "moiregauge/io/pictures/tiff_reader.h"

#include <algorithm>

#include "tests/fuzz/picture_trial.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const fuzz::InputFile file({data, size});
  const auto stack = TiffStack::open(file.path());
  if (!stack) return 0;
  const long pages = std::min(4L, (*stack)->pages());
  for (long page = 0; page < pages; ++page) fuzz::look_at((*stack)->read(page));
  if (pages > 1) fuzz::look_at((*stack)->read(0));
  return 0;
}
