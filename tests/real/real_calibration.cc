// SPDX-License-Identifier: Apache-2.0
#include "real/real_calibration.h"

#include <algorithm>
#include <stdexcept>

namespace moiregauge::internal::test {
namespace {

std::vector<double> nulls(const std::vector<LatticeView>& views, const Camera& camera) {
  std::vector<double> out;
  const Places first = without_lens(views.front().places, camera);
  for (std::size_t i = 1; i < views.size(); ++i) {
    const LatticeNull null = null_between(first, without_lens(views[i].places, camera));
    if (null.targets > 0) out.push_back(null.rms_px);
  }
  std::sort(out.begin(), out.end());
  if (out.empty()) throw std::runtime_error("no two views show the same points");
  return out;
}

}  // namespace

BoardCalibration calibrated(const std::vector<LatticeView>& views) {
  std::vector<BoardView> boards;
  for (const LatticeView& view : views) {
    const LumaView luma = view_of(view.picture);
    const auto board = find_board({luma, view.picture.bits});
    const int width = width_of(luma), height = height_of(luma);
    boards.push_back(board ? board_view(*board, 10.0, width, height) : BoardView{width, height, {}});
  }
  auto solved = calibrate_board(boards, {});
  if (!solved) throw std::runtime_error(solved.error());
  return *std::move(solved);
}

Places without_lens(const Places& places, const Camera& camera) {
  Places out;
  for (const auto& [place, at] : places) {
    const IdealPoint ideal = camera.undistort(at);
    out[place] = {ideal.x, ideal.y};
  }
  return out;
}

double median_null(const std::vector<LatticeView>& views, const Camera& camera) {
  const auto all = nulls(views, camera);
  return 0.5 * (all[(all.size() - 1) / 2] + all[all.size() / 2]);
}

double worst_null(const std::vector<LatticeView>& views, const Camera& camera) { return nulls(views, camera).back(); }

}  // namespace moiregauge::internal::test
