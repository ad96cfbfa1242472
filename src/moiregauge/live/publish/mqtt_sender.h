// SPDX-License-Identifier: Apache-2.0
// Sends blocks to an MQTT broker (3.1.1), each message with QoS 1: the broker has it at least once.
#pragma once

#include <memory>
#include <string>

#include "moiregauge/live/publish/block_outlet.h"
#include "moiregauge/live/publish/outlet_url.h"

namespace moiregauge::internal {

struct MqttOptions {
  OutletUrl url;         // scheme mqtt or mqtts (TLS); its path is the topic
  std::string password;  // password of url.user
  std::string ca_file;   // certificates for mqtts, PEM; empty: the system's
};

// Topics below that of the address: /rows and /health once a second, /alarm at each change, and /status.
// The status is retained. It is `online` or `offline`. The broker sets it to `lost` if this program ends without a
// goodbye.
[[nodiscard]] std::unique_ptr<BlockSender> mqtt_sender(MqttOptions options);

}  // namespace moiregauge::internal
