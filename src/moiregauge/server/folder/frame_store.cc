// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/frame_store.h"

#include <sys/stat.h>

#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "moiregauge/app/open_input.h"

namespace moiregauge::internal {
namespace {

// Frames further ahead are reached from a key frame. Chosen: a group of pictures rarely has more.
constexpr long kMaxDecodedAhead = 120;

template <typename Grey>
Image<Grey> copy_of(const ImageView<Grey>& view) {
  Image<Grey> out(view.width, view.height);
  for (int y = 0; y < view.height; ++y) std::ranges::copy(view.row(y), out.row(y).begin());
  return out;
}

template <typename Grey>
Image<Grey> copy_if(const LumaView& luma) {
  const auto* view = std::get_if<ImageView<Grey>>(&luma);
  return view != nullptr ? copy_of(*view) : Image<Grey>();
}

// A clip that is replaced under the same name has another key.
std::string key_of(const std::string& path) {
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) return path;
  return fmt::format("{}\n{}\n{}.{}\n{}", path, facts.st_size, facts.st_mtim.tv_sec, facts.st_mtim.tv_nsec,
                     facts.st_ino);
}

}  // namespace

KeptFrame::Quantisers::Quantisers(const QuantiserMap& map) : whole(map.whole), blocks(copy_of(map.blocks)) {}

KeptFrame::KeptFrame(const InputInfo& info, const Frame& frame)
    : input(info),
      number(frame.number),
      time_s(frame.time_s),
      damaged(frame.damaged),
      bytes_(copy_if<std::uint8_t>(frame.luma)),
      words_(copy_if<std::uint16_t>(frame.luma)),
      quantisers_(frame.quantiser) {}

Frame KeptFrame::frame() const {
  const LumaView luma = words_.width() > 0 ? LumaView(words_.view()) : LumaView(bytes_.view());
  return {number, time_s, damaged, luma, quantisers_.map()};
}

std::optional<QuantiserMap> KeptFrame::next_quantiser() const {
  if (!next_) return std::nullopt;
  return next_->map();
}

std::int64_t KeptFrame::bytes() const {
  return std::int64_t{1} * bytes_.width() * bytes_.height() + std::int64_t{2} * words_.width() * words_.height();
}

std::shared_ptr<const KeptFrame> FrameStore::kept(const std::string& key, long number) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(
      frames_, [&](const Kept& kept) { return kept.second->number == number && kept.first == key; });
  if (found == frames_.end()) return nullptr;
  frames_.splice(frames_.begin(), frames_, found);
  return found->second;
}

void FrameStore::keep(const std::string& key, std::shared_ptr<const KeptFrame> frame) {
  const std::lock_guard lock(mutex_);
  frames_.emplace_front(key, std::move(frame));
  std::int64_t bytes = 0;
  for (auto i = frames_.begin(); i != frames_.end(); ++i) {
    bytes += i->second->bytes();
    if (i == frames_.begin() || bytes <= limits_.max_bytes) continue;
    frames_.erase(i, frames_.end());
    return;
  }
}

std::shared_ptr<FrameStore::Reader> FrameStore::reader_of(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(readers_, key, [](const auto& reader) { return reader->key; });
  if (found != readers_.end()) {
    readers_.splice(readers_.begin(), readers_, found);
  } else {
    readers_.push_front(std::make_shared<Reader>());
    readers_.front()->key = key;
    if (readers_.size() > limits_.max_readers) readers_.pop_back();
  }
  return readers_.front();
}

tl::expected<std::shared_ptr<const KeptFrame>, std::string> FrameStore::read(Reader& reader, const std::string& path,
                                                                             long number) {
  const auto open = [&](long first) -> tl::expected<void, std::string> {
    auto source = open_input_from(first, path, {});
    reader.source.reset();
    reader.last = nullptr;
    reader.is_at_end = false;
    reader.has_skipped = first > 0;
    reader.reached = -1;
    if (!source) return tl::unexpected(source.error().message);
    reader.source = *std::move(source);
    return {};
  };
  const bool is_behind = reader.last ? reader.last->number > number : reader.reached >= number;
  const bool is_far = number > reader.reached + kMaxDecodedAhead;
  if (!reader.source || reader.is_at_end || is_behind || is_far) {
    const auto opened = open(number);
    if (!opened && number == 0) return tl::unexpected(opened.error());
  }
  if (reader.source) {
    auto found = read_on(reader, path, number);
    if (!reader.has_skipped || (found && !(*found)->damaged)) return found;
  }
  if (const auto opened = open(0); !opened) return tl::unexpected(opened.error());
  return read_on(reader, path, number);
}

tl::expected<std::shared_ptr<const KeptFrame>, std::string> FrameStore::read_on(Reader& reader, const std::string& path,
                                                                                long number) {
  // One frame more than `number` is decoded, for its quantiser.
  while (!reader.is_at_end) {
    auto next = reader.source->next();
    if (!next && !(reader.last && reader.last->number == number)) {
      reader.is_at_end = true;
      return tl::unexpected(next.error().message);
    }
    reader.is_at_end = !next || !*next;
    if (!reader.is_at_end) reader.reached = (*next)->number;
    if (!reader.is_at_end && (*next)->number <= number) {
      reader.last = (*next)->number == number ? std::make_shared<KeptFrame>(reader.source->info(), **next) : nullptr;
      continue;
    }
    std::shared_ptr<KeptFrame> wanted = std::exchange(reader.last, nullptr);
    if (!reader.is_at_end) {
      if (wanted) wanted->next_.emplace((*next)->quantiser);
      reader.last = std::make_shared<KeptFrame>(reader.source->info(), **next);
    }
    if (!wanted || wanted->number != number) break;
    if (!(reader.has_skipped && wanted->damaged)) keep(reader.key, wanted);
    return wanted;
  }
  return tl::unexpected(fmt::format("the frame does not exist: {}, frame {}: choose a lower number", path, number));
}

tl::expected<std::shared_ptr<const KeptFrame>, std::string> FrameStore::frame(const std::string& path, long number) {
  const std::string key = key_of(path);
  if (auto found = kept(key, number)) return found;
  const auto reader = reader_of(key);
  const std::lock_guard lock(reader->mutex);
  if (auto found = kept(key, number)) return found;  // read by another thread meanwhile
  return read(*reader, path, number);
}

void FrameStore::clear() {
  const std::lock_guard lock(mutex_);
  readers_.clear();
  frames_.clear();
}

}  // namespace moiregauge::internal
