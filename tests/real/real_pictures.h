// SPDX-License-Identifier: Apache-2.0
// Photographs of tests/real/data, and runs on them. The boards are rigid, so each measured displacement is an error.
#pragma once

#include <string>

#include "moiregauge/io/pictures/picture.h"
#include "moiregauge/run/measure.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal::test {

[[nodiscard]] Site real_site(const std::string& set);
[[nodiscard]] Picture real_picture(const std::string& set, const std::string& file);
[[nodiscard]] Measurement real_run(const std::string& set, const std::string& method);
[[nodiscard]] Measurement real_run(const std::string& set, const std::string& method, Site site);

// Returns the site of the set with nine targets of two periods each instead of its own, and the same references.
[[nodiscard]] Site nine_patches(const std::string& set);

// Returns the length in px of the first target's displacement in the second view. The truth is zero.
[[nodiscard]] double null_px(const Measurement& measurement);
// Returns the rms of these lengths over all targets.
[[nodiscard]] double rms_null_px(const Measurement& measurement);
[[nodiscard]] const Sample& second_view(const Measurement& measurement);

}  // namespace moiregauge::internal::test
