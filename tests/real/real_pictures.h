// SPDX-License-Identifier: Apache-2.0
// The photographs of tests/real/data, and runs on them. Their boards are rigid: every displacement measured is an
// error.
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

// The board of the set with nine targets of two periods each in place of its own, the same references.
[[nodiscard]] Site nine_patches(const std::string& set);

// Length of the first target's displacement in the second view, px of the picture (a null: the truth is zero); and rms
// over all targets.
[[nodiscard]] double null_px(const Measurement& measurement);
[[nodiscard]] double rms_null_px(const Measurement& measurement);
[[nodiscard]] const Sample& second_view(const Measurement& measurement);

}  // namespace moiregauge::internal::test
