// SPDX-License-Identifier: Apache-2.0
// The SIMD targets of this program. Include before every header of Highway, in each file that has a loop per target.
#pragma once

// Includes the scalar target, to which the tests compare the others.
#define HWY_COMPILE_ALL_ATTAINABLE
// Processors with SSSE3 but without SSE4 were made in 2006 and 2007. They use the next lower target.
#define HWY_DISABLED_TARGETS HWY_SSSE3
