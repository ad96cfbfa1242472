// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibrate_board.h"

#include "moiregauge/app/calibrate/calibrate_photos.h"
#include "moiregauge/app/calibrate/calibration_check.h"
#include "moiregauge/library/convert.h"

namespace moiregauge {

Expected<CalibratedCamera> calibrate_board(const std::vector<std::string>& photos, Millimetres pitch) {
  if (photos.empty() || !(pitch.value() > 0.0))
    return internal::public_error(internal::Exit::kUsage,
                                  "photographs or pitch are missing: calibrate_board: give both, e.g. 10_mm");
  const auto report = internal::calibrate_photos(photos, pitch.value(), {}, {});
  if (!report) return internal::public_error(report.error().exit, report.error().message);
  if (const auto refusal = internal::calibrate_refusal(*report, photos.front()))
    return internal::public_error(internal::Exit::kRefused, *refusal);
  CalibratedCamera out;
  const internal::BoardCalibration& solved = report->solved;
  out.camera = internal::to_public(solved.camera);
  const auto& u = solved.u;
  out.u = {solved.camera.width, solved.camera.height, u[0], u[0], u[1], u[2], u[3], u[4], u[5], u[6], u[7]};
  out.rms_px = solved.rms_px;
  for (std::size_t v = 0; v < solved.views.size(); ++v)
    out.views.push_back({report->names[v], solved.views[v].excluded, solved.views[v].rms_px});
  return out;
}

}  // namespace moiregauge
