// SPDX-License-Identifier: Apache-2.0
// Sends blocks as InfluxDB line protocol, to a file or over HTTP.
#pragma once

#include <memory>
#include <string>

#include "moiregauge/live/publish/block_outlet.h"
#include "moiregauge/live/publish/outlet_url.h"

namespace moiregauge::internal {

// Appends to a file, which is opened for each block, so that a program like Telegraf or logrotate may move it away.
[[nodiscard]] std::unique_ptr<BlockSender> influx_file_sender(std::string path);

// Posts to the address. Its path and query choose the database, as in `/api/v2/write?org=o&bucket=b`.
// A status of 400 to 499, except 429, means that the server will never take the block.
[[nodiscard]] std::unique_ptr<BlockSender> influx_http_sender(OutletUrl url, std::string token);

}  // namespace moiregauge::internal
