// SPDX-License-Identifier: Apache-2.0
// Options that several commands share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "moiregauge/app/measure_options.h"

namespace moiregauge::internal::cli {

// Adds --print-scale and --u-print-scale.
void add_print_scale(CLI::App& command, PrintScaleArgs& args);

// Adds --slow-motion.
void add_slow_motion(CLI::App& command, std::optional<double>& factor);

// Adds the options that choose markers: --references, --targets, --ignore, --name, --region, --exclude-region.
void add_marker_choice(CLI::App& command, MarkerChoiceArgs& args);

// Adds --figures.
void add_figures(CLI::App& command, std::string& formats);

// Adds --max-pixels.
void add_max_pixels(CLI::App& command, std::int64_t& max_pixels);

}  // namespace moiregauge::internal::cli
