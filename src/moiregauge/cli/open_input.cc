// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/open_input.h"

#include <filesystem>
#include <system_error>

#include "moiregauge/io/picture_file.h"
#include "moiregauge/io/picture_source.h"

namespace moiregauge {

tl::expected<std::unique_ptr<FrameSource>, InputError> open_input(const std::string& path, const InputOptions& options) {
  return open_pictures(path, options);
}

}  // namespace moiregauge
