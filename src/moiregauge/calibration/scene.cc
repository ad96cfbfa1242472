// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene.h"

namespace moiregauge {

std::string SceneModel::name() const {
  std::string text = "plane";
  if (radial) text += " + radial";
  if (tangential) text += " + tangential";
  if (heights) text += " + heights";
  if (depth) text += " + depth";
  return text;
}

}  // namespace moiregauge
