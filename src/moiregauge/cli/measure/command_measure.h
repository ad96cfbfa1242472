// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "moiregauge/app/measure_options.h"

namespace moiregauge::internal::cli {

// Registers `moiregauge measure`; running it sets exit_code.
void add_measure(CLI::App& app, int& exit_code);

// Options that `live` shares with `measure`: markers and gratings, the camera, the method.
void add_print_options(CLI::App& command, MeasureArgs& args);
void add_camera_options(CLI::App& command, MeasureArgs& args);
void add_method_options(CLI::App& command, MeasureArgs& args);

}  // namespace moiregauge::internal::cli
