// SPDX-License-Identifier: Apache-2.0
// The yardsticks and our chains beside them in one program, so that ratios can be taken within one run:
// bench/ratios.py does.
#include <glog/logging.h>
#include <opencv2/core.hpp>

#include "cases.h"

int main(int argc, char** argv) {
  FLAGS_minloglevel = google::GLOG_FATAL;  // the scene's solver writes of every step it shortens
  cv::setNumThreads(1);
  moiregauge::bench::add_yardstick_cases();
  moiregauge::bench::add_chain_cases();
  moiregauge::bench::add_stage_cases();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("last_level_cache_bytes", std::to_string(moiregauge::bench::last_level_cache_bytes()));
  benchmark::RunSpecifiedBenchmarks();
}
