// SPDX-License-Identifier: Apache-2.0
// Frames of clips for the page, decoded once and kept for a while.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

// A frame with its own pixels.
class KeptFrame {
 public:
  KeptFrame(const InputInfo& info, const Frame& frame);
  InputInfo input;
  long number = 0;
  double time_s = 0.0;
  bool damaged = false;
  // Quantiser of the next frame. Nothing: this is the last frame.
  [[nodiscard]] std::optional<QuantiserMap> next_quantiser() const;
  // Refers to this object.
  [[nodiscard]] Frame frame() const;
  [[nodiscard]] std::int64_t bytes() const;

 private:
  friend class FrameStore;
  struct Quantisers {
    Quantiser whole;
    Image<std::uint8_t> blocks;
    explicit Quantisers(const QuantiserMap& map);
    [[nodiscard]] QuantiserMap map() const { return {whole, blocks.view()}; }
  };
  Image<std::uint8_t> bytes_;   // 8 bits, or
  Image<std::uint16_t> words_;  // more bits
  Quantisers quantisers_;
  std::optional<Quantisers> next_;
};

struct FrameLimits {
  std::size_t max_readers = 4;         // open clips, each with its decoder process
  std::int64_t max_bytes = 400 << 20;  // pixels of kept frames
};

// Decodes forwards. A frame further away is decoded from a key frame before it. If that fails, or the frame is marked
// damaged, it is decoded again from the start of the clip, which settles number and mark.
class FrameStore {
 public:
  explicit FrameStore(const FrameLimits& limits = {}) : limits_(limits) {}
  // Returns a frame of a clip or an image folder by its absolute path. Safe on any thread.
  // Fails with "what: where: what to do": an unreadable clip, or no such frame.
  [[nodiscard]] tl::expected<std::shared_ptr<const KeptFrame>, std::string> frame(const std::string& path, long number);
  // Closes all decoders.
  void clear();

 private:
  struct Reader {
    std::string key;  // path and version of the file
    std::mutex mutex;
    std::unique_ptr<FrameSource> source;
    std::shared_ptr<KeptFrame> last;  // waits for the quantiser of the next frame
    bool is_at_end = false;
    bool has_skipped = false;  // it did not begin at the start
    long reached = -1;         // the last frame that was decoded
  };
  using Kept = std::pair<std::string, std::shared_ptr<const KeptFrame>>;

  [[nodiscard]] std::shared_ptr<const KeptFrame> kept(const std::string& key, long number);
  [[nodiscard]] std::shared_ptr<Reader> reader_of(const std::string& key);
  [[nodiscard]] tl::expected<std::shared_ptr<const KeptFrame>, std::string> read(Reader& reader,
                                                                                 const std::string& path, long number);
  [[nodiscard]] tl::expected<std::shared_ptr<const KeptFrame>, std::string> read_on(Reader& reader,
                                                                                    const std::string& path,
                                                                                    long number);
  void keep(const std::string& key, std::shared_ptr<const KeptFrame> frame);

  const FrameLimits limits_;
  std::mutex mutex_;  // protects the two lists, newest first
  std::list<std::shared_ptr<Reader>> readers_;
  std::list<Kept> frames_;
};

}  // namespace moiregauge::internal
