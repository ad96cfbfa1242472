// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/patch_pass.h"

#include <array>
#include <variant>

#include "moiregauge/image/simd_options.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/phase/fit/patch_pass.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "moiregauge/phase/fit/patch_job.h"
#include "moiregauge/phase/fit/patch_rows-inl.h"
#include "moiregauge/phase/fit/patch_tiles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
// Vectors are parameters of their own, because some targets do not allow them in structs.
// NOLINTBEGIN(readability-function-size)
namespace HWY_NAMESPACE {

template <typename Grey>
void pass_of(const PatchJob& job, const ImageView<Grey>& picture, Sum sum, PatchTotals& out) {
  switch (sum) {
    case Sum::kRight:
      return pass_by_tiles<Sum::kRight>(job, picture, out);
    case Sum::kNormal:
      return pass_by_tiles<Sum::kNormal>(job, picture, out);
    case Sum::kShift:
      return pass_by_rows<Sum::kShift>(job, picture, out);
    case Sum::kBlocks:
      return pass_by_rows<Sum::kBlocks>(job, picture, out);
  }
}

void Pass8(const PatchJob& job, const ImageView<std::uint8_t>& p, Sum sum, PatchTotals& out) {
  pass_of(job, p, sum, out);
}
void Pass16(const PatchJob& job, const ImageView<std::uint16_t>& p, Sum sum, PatchTotals& out) {
  pass_of(job, p, sum, out);
}

}  // namespace HWY_NAMESPACE
// NOLINTEND(readability-function-size)
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace moiregauge::internal {
HWY_EXPORT(Pass8);
HWY_EXPORT(Pass16);

namespace {

void dispatched(const LumaView& luma, const PatchJob& job, Sum sum, PatchTotals& out) {
  if (const auto* view = std::get_if<ImageView<std::uint8_t>>(&luma))
    HWY_DYNAMIC_DISPATCH(Pass8)(job, *view, sum, out);
  else
    HWY_DYNAMIC_DISPATCH(Pass16)(job, *std::get_if<ImageView<std::uint16_t>>(&luma), sum, out);
}

}  // namespace

PatchSums sum_patch(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
                    NormalMatrix* normal) {
  PatchSums sums;
  PatchTotals totals;
  totals.normal = normal;
  if (normal != nullptr) normal->setZero();
  dispatched(luma, job_of(model, nodes, box, {}), normal == nullptr ? Sum::kRight : Sum::kNormal, totals);
  sums.right = Eigen::Map<const NormalVector>(totals.sums.data());
  sums.left2 = totals.sums[kColumns];
  sums.pixels = totals.pixels;
  if (normal != nullptr) *normal = NormalMatrix(normal->selfadjointView<Eigen::Lower>());
  return sums;
}

ShiftSums sum_shift(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
                    const PixelSteps& steps) {
  ShiftSums sums;
  PatchTotals totals;
  dispatched(luma, job_of(model, nodes, box, steps), Sum::kShift, totals);
  std::size_t from = 0;
  for (int i = 0; i < kShiftColumns; ++i) sums.right(i) = totals.sums[from++];
  sums.left2 = totals.sums[from++];
  for (int i = 0; i < kShiftColumns; ++i) {
    for (int j = 0; j <= i; ++j) sums.normal(i, j) = sums.normal(j, i) = totals.sums[from++];
  }
  sums.pixels = totals.pixels;
  return sums;
}

BlockSums sum_blocks(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
                     int row_step) {
  BlockSums sums;
  PatchTotals totals;
  totals.blocks = &sums;
  dispatched(luma, job_of(model, nodes, box, {row_step}), Sum::kBlocks, totals);
  return sums;
}

}  // namespace moiregauge::internal
#endif
