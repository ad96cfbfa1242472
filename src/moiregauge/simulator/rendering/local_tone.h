// SPDX-License-Identifier: Apache-2.0
// Local tone mapping by histogram equalisation in tiles with a limited slope (CLAHE; Zuiderveld 1994).
#pragma once

#include "moiregauge/image/image.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

// Takes every grey level `strength` of the way to what its tile's equalisation makes of it, joined between tiles by
// straight lines.
void map_local_tones(const LocalTone& how, Image<double>& picture);

}  // namespace moiregauge::internal::simulator
