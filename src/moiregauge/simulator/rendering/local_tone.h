// SPDX-License-Identifier: Apache-2.0
// Local tone mapping by histogram equalisation in tiles with a limited slope (CLAHE; Zuiderveld 1994).
#pragma once

#include "moiregauge/image/image.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

// Moves each grey level by the share `strength` towards its equalised value. Between the middles of tiles the curves
// are interpolated linearly.
void map_local_tones(const LocalTone& how, Image<double>& picture);

}  // namespace moiregauge::internal::simulator
