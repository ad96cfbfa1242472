// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "moiregauge/app/measure_options.h"

namespace moiregauge::internal::cli {

// Registers `moiregauge measure`; running it sets exit_code.
void add_measure(CLI::App& app, int& exit_code);

// Options that `live` and `batch` share with `measure`: markers and gratings, the camera, the method.
void add_print_options(CLI::App& command, MeasureArgs& args);
void add_camera_options(CLI::App& command, MeasureArgs& args);
void add_method_options(CLI::App& command, MeasureArgs& args);
// Options that `batch` shares with `measure`: the frames of each clip, figures and video.
void add_frame_options(CLI::App& command, MeasureArgs& args);
void add_drawing_options(CLI::App& command, MeasureArgs& args);

}  // namespace moiregauge::internal::cli
