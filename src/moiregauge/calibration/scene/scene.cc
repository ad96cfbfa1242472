// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/scene.h"

#include <cmath>

namespace moiregauge::internal {
namespace {

constexpr double kDeterminedFocal = 0.1;  // largest relative u of f for a camera file; chosen

}  // namespace

std::string SceneModel::name() const {
  std::string text = "plane";
  if (radial) text += " + radial";
  if (tangential) text += " + tangential";
  if (heights) text += " + heights";
  if (depth) text += " + depth";
  if (tilts) text += " + tilts";
  return text;
}

bool determines_camera(const Scene& scene) {
  const Eigen::MatrixXd& covariance = scene.stated_covariance();
  return scene.solved && scene.model.radial && covariance.size() > 0 &&
         std::sqrt(covariance(0, 0)) <= kDeterminedFocal * scene.camera.fx;
}

}  // namespace moiregauge::internal
