// SPDX-License-Identifier: Apache-2.0
// The reader of run.mgj is linked with the table of methods, but the readers under test never call a method. These
// stubs replace the methods, so that half the instrument and Ceres need not be built.
#include <cstdlib>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

Observation observe_conventional(const GreyPicture&, const Reference&, const Prediction&) { std::abort(); }
Observation observe_two_stage(const GreyPicture&, const Reference&, const Prediction&) { std::abort(); }
Observation observe_precise(const GreyPicture&, const Reference&, const Prediction&) { std::abort(); }
void learn_prints(const GreyPicture&, Reference&) { std::abort(); }
Solution solve_conventional(const Reference&, const Observations&, const SolveOptions&) { std::abort(); }
Solution solve_two_stage(const Reference&, const Observations&, const SolveOptions&) { std::abort(); }
Solution solve_precise(const Reference&, const Observations&, const SolveOptions&) { std::abort(); }

}  // namespace moiregauge::internal
