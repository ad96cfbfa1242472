// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {

const char* word_for(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kUntrusted:
      return "untrusted";
    case Status::kCameraMoved:
      return "camera-moved";
    case Status::kBlurred:
      return "blurred";
    case Status::kSaturated:
      return "saturated";
    case Status::kPartlyCovered:
      return "partly-covered";
    case Status::kLost:
      return "lost";
    case Status::kReferenceLost:
      return "reference-lost";
    case Status::kOrderUnproven:
      return "order-unproven";
    case Status::kDecodeError:
      return "decode-error";
    case Status::kTooCoarse:
      return "too-coarse";
  }
  return "lost";
}

bool has_numbers(Status status) { return status <= Status::kPartlyCovered; }

}  // namespace moiregauge::internal
