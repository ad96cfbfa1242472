// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/budget_errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace moiregauge::internal {
namespace {

void put_value(const Sample& sample, Extent<frame::Board> axis, Eigen::Index row, FrameErrors& errors) {
  const auto along = [&](Extent<frame::Board> part) { return axis.x * part.x + axis.y * part.y; };
  const double u = along(sample.u), shared = along(sample.budget.reference_frame);
  if (!std::isfinite(u)) return;
  const double noise = along(sample.budget.noise), references = along(sample.budget.references);
  errors.varying(row, row) = shared;
  errors.noise(row, row) = std::max(0.0, u * u - shared * shared);
  errors.bounded(row, row) = std::max(0.0, errors.noise(row, row) - noise * noise - references * references);
}

}  // namespace

JointErrors budget_errors(const Site& site, const Samples& samples) {
  JointErrors joint;
  joint.knows_common_errors = false;
  joint.u_position_mm = site.known_to.position_mm;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (site.markers[i].role != Role::kTarget || !site.markers[i].grating) continue;
    joint.targets.push_back(i);
    joint.positions.push_back(site.markers[i].grating->centre);
  }
  const std::size_t targets = joint.targets.size();
  const Eigen::Index rows = kQuantities * static_cast<Eigen::Index>(targets);
  joint.constant = Eigen::MatrixXd(rows, 0);
  for (std::size_t first = 0; targets > 0 && first + targets <= samples.size(); first += targets) {
    FrameErrors errors;
    errors.rotation_rad = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(targets), kNotMeasured);
    errors.noise = errors.bounded = errors.varying = Eigen::MatrixXd::Zero(rows, rows);
    for (std::size_t t = 0; t < targets; ++t) {
      put_value(samples[first + t], {1.0, 0.0}, quantity_row(t, Quantity::kDx), errors);
      put_value(samples[first + t], {0.0, 1.0}, quantity_row(t, Quantity::kDy), errors);
    }
    joint.frames.push_back(std::move(errors));
  }
  return joint;
}

}  // namespace moiregauge::internal
