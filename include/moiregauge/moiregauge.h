// SPDX-License-Identifier: Apache-2.0
// All of the library.
#pragma once

#include "moiregauge/calibrate_board.h"
#include "moiregauge/camera.h"
#include "moiregauge/errors.h"
#include "moiregauge/image.h"
#include "moiregauge/measure.h"
#include "moiregauge/plan.h"
#include "moiregauge/result.h"
#include "moiregauge/run.h"
#include "moiregauge/sampling_moire.h"
#include "moiregauge/simulate.h"
#include "moiregauge/site.h"
#include "moiregauge/tracker.h"
#include "moiregauge/units.h"
#include "moiregauge/version.h"
