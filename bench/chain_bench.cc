// SPDX-License-Identifier: Apache-2.0
// Reference implementations and our chains in one program, so that bench/ratios.py can compute ratios within one run.
// MOIREGAUGE_SIMD=avx2 selects narrower vectors than those of the machine.
#include <cstdlib>
#include <iostream>

#include <opencv2/core.hpp>

#include "cases.h"
#include "moiregauge/phase/fit/simd_target.h"

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const auto targets = moiregauge::internal::simd_targets();
  const char* const asked = std::getenv("MOIREGAUGE_SIMD");
  const std::string target = asked != nullptr ? asked : targets.front();
  if (!moiregauge::internal::use_simd_target(target)) {
    std::cerr << "error: MOIREGAUGE_SIMD=" << target << " is not of this machine\n";
    return 2;
  }
  moiregauge::internal::bench::add_yardstick_cases();
  moiregauge::internal::bench::add_chain_cases();
  moiregauge::internal::bench::add_stage_cases();
  moiregauge::internal::bench::add_peer_cases();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("last_level_cache_bytes",
                              std::to_string(moiregauge::internal::bench::last_level_cache_bytes()));
  benchmark::AddCustomContext("simd", target);
  benchmark::RunSpecifiedBenchmarks();
}
