// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/hevc_headers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "moiregauge/decoder/headers/bit_reader.h"

namespace moiregauge::internal {
namespace {

// Types of NAL units (Table 7-1).
constexpr int kLastSlice = 21, kFirstRandomAccess = 16, kLastRandomAccess = 23, kIdrWithLeading = 19, kIdr = 20;
constexpr int kSequenceSet = 33, kPictureSet = 34;
// Slice headers are shorter, and parameter sets rarely exceed 100 bytes (chosen).
constexpr std::size_t kMaxHeaderBytes = 4096;
constexpr int kMaxSets = 64, kMaxNeighbours = 16, kMaxLongTerm = 32, kMaxReferences = 15;
constexpr int kMinParameter = -48, kMaxParameterOf8Bits = 51;
constexpr int kLargest = 1 << 24;  // limit of numbers without a tighter one
enum SliceType { kB = 0, kP = 1, kI = 2 };

// Ceil(Log2(count)).
int bits_for(int count) { return count <= 1 ? 0 : static_cast<int>(std::bit_width(static_cast<unsigned>(count - 1))); }

void skip_profile_tier_level(BitReader& bits, int sub_layers) {
  bits.skip(88 + 8);  // general_profile_space to general_level_idc
  std::array<bool, 8> has_profile{}, has_level{};
  const auto count = static_cast<std::size_t>(sub_layers - 1);
  for (std::size_t k = 0; k < count; ++k) has_profile[k] = bits.flag(), has_level[k] = bits.flag();
  if (count > 0) bits.skip(2 * (8 - static_cast<int>(count)));
  for (std::size_t k = 0; k < count; ++k) bits.skip((has_profile[k] ? 88 : 0) + (has_level[k] ? 8 : 0));
}

// 7.3.4
void skip_scaling_lists(BitReader& bits) {
  for (int size = 0; size < 4; ++size) {
    for (int matrix = 0; matrix < 6; matrix += size == 3 ? 3 : 1) {
      if (!bits.flag()) {
        (void)bits.number(kLargest);
        continue;
      }
      if (size > 1) (void)bits.signed_number(kLargest / 2);
      const int coefficients = std::min(64, 1 << (4 + 2 * size));
      for (int k = 0; k < coefficients && bits.good(); ++k) (void)bits.signed_number(kLargest / 2);
    }
  }
}

// 7.3.6.3, for the images of one layer.
void skip_weights(BitReader& bits, bool has_chroma, std::span<const int> references) {
  (void)bits.number(7);
  if (has_chroma) (void)bits.signed_number(7);
  for (const int count : references) {
    std::array<bool, kMaxReferences> luma{}, chroma{};
    const auto used = static_cast<std::size_t>(count);
    for (std::size_t k = 0; k < used; ++k) luma[k] = bits.flag();
    for (std::size_t k = 0; k < used && has_chroma; ++k) chroma[k] = bits.flag();
    for (std::size_t k = 0; k < used; ++k) {
      const int numbers = (luma[k] ? 2 : 0) + (chroma[k] ? 4 : 0);
      for (int n = 0; n < numbers; ++n) (void)bits.signed_number(kLargest / 2);
    }
  }
}

}  // namespace

// 7.3.7 and 7.4.8: an explicit set, or one predicted from an earlier one.
std::optional<HevcHeaders::PictureSet> HevcHeaders::read_set(BitReader& bits, const std::vector<PictureSet>& before,
                                                             bool in_slice) {
  PictureSet set;
  const int index = static_cast<int>(before.size());
  if (index > 0 && bits.flag()) {
    const int back = in_slice ? 1 + bits.number(kMaxSets) : 1;
    const bool negative = bits.flag();
    const int by = (1 + bits.number(1 << 15)) * (negative ? -1 : 1);
    if (back > index) return std::nullopt;
    const PictureSet& from = before[static_cast<std::size_t>(index - back)];
    for (std::size_t k = 0; k <= from.size(); ++k) {
      const bool used = bits.flag();
      const bool kept = used || bits.flag();
      const int delta = (k < from.size() ? from[k].delta_poc : 0) + by;
      if (kept && delta != 0) set.push_back({delta, used});
    }
    // Order of 7-61 and 7-62: earlier images from the nearest on, then later ones.
    std::stable_sort(set.begin(), set.end(), [](Neighbour a, Neighbour b) {
      return (a.delta_poc > 0) != (b.delta_poc > 0) ? a.delta_poc < 0 : std::abs(a.delta_poc) < std::abs(b.delta_poc);
    });
  } else {
    const int counts[] = {bits.number(kMaxNeighbours), bits.number(kMaxNeighbours)};
    for (const int side : {0, 1}) {
      int delta = 0;
      for (int k = 0; k < counts[side]; ++k) {
        delta += (1 + bits.number(1 << 15)) * (side == 0 ? -1 : 1);
        set.push_back({delta, bits.flag()});
      }
    }
  }
  if (!bits.good() || set.size() > kMaxNeighbours) return std::nullopt;
  return set;
}

// Reads 7.3.2.2, as far as slice headers depend on it.
void HevcHeaders::read_sequence(BitReader& bits) {
  Sequence s;
  bits.skip(4);
  const int sub_layers = 1 + static_cast<int>(bits.bits(3));
  if (sub_layers > 7) return;
  bits.skip(1);
  skip_profile_tier_level(bits, sub_layers);
  const auto id = static_cast<std::size_t>(bits.number(static_cast<int>(sequences_.size()) - 1));
  s.chroma_format = bits.number(3);
  s.separate_planes = s.chroma_format == 3 && bits.flag();
  const int width = bits.number(1 << 16), height = bits.number(1 << 16);
  if (bits.flag()) {
    for (int k = 0; k < 4; ++k) (void)bits.number(1 << 16);
  }
  (void)bits.number(8), (void)bits.number(8);  // luma and chroma depths
  s.poc_bits = 4 + bits.number(12);
  const bool all_layers = bits.flag();
  for (int k = all_layers ? 0 : sub_layers - 1; k < sub_layers; ++k) {
    for (int n = 0; n < 3; ++n) (void)bits.number(kLargest);
  }
  const int smallest = 3 + bits.number(3);
  const int largest = smallest + bits.number(3);
  for (int k = 0; k < 4; ++k) (void)bits.number(16);  // transform blocks
  if (bits.flag() && bits.flag()) skip_scaling_lists(bits);
  bits.skip(1);
  s.has_sao = bits.flag();
  if (bits.flag()) {  // pulse code modulation
    bits.skip(8);
    (void)bits.number(16), (void)bits.number(16);
    bits.skip(1);
  }
  const int sets = bits.number(kMaxSets);
  for (int k = 0; k < sets; ++k) {
    auto set = read_set(bits, s.sets, false);
    if (!set) return;
    s.sets.push_back(*std::move(set));
  }
  s.has_long_term = bits.flag();
  const int listed = s.has_long_term ? bits.number(kMaxLongTerm) : 0;
  for (int k = 0; k < listed; ++k) {
    bits.skip(s.poc_bits);
    s.long_term_used.push_back(bits.flag());
  }
  s.has_temporal_vectors = bits.flag();
  const int side = 1 << largest;
  const auto blocks = [side](int pixels) { return (pixels + side - 1) / side; };
  s.address_bits = bits_for(std::max(1, blocks(width) * std::max(1, blocks(height))));
  if (bits.good()) sequences_[id] = std::move(s);
}

// Reads 7.3.2.3 up to lists_modification_present_flag.
void HevcHeaders::read_picture(BitReader& bits) {
  Picture p;
  const auto id = static_cast<std::size_t>(bits.number(static_cast<int>(pictures_.size()) - 1));
  p.sequence = static_cast<std::size_t>(bits.number(static_cast<int>(sequences_.size()) - 1));
  p.has_dependent_slices = bits.flag();
  p.has_output_flag = bits.flag();
  p.extra_bits = static_cast<int>(bits.bits(3));
  bits.skip(1);
  p.has_cabac_init = bits.flag();
  for (int& count : p.references) count = 1 + bits.number(kMaxReferences - 1);
  p.parameter = 26 + bits.signed_number(80);
  bits.skip(2);
  p.varies = bits.flag();
  if (p.varies) (void)bits.number(3);
  (void)bits.signed_number(12), (void)bits.signed_number(12);
  bits.skip(1);
  p.weighted = bits.flag();
  p.weighted_both_ways = bits.flag();
  bits.skip(1);
  const bool has_tiles = bits.flag();
  bits.skip(1);
  if (has_tiles) {
    const int columns = bits.number(1 << 12), rows = bits.number(1 << 12);
    if (!bits.flag()) {
      for (int k = 0; k < columns + rows && bits.good(); ++k) (void)bits.number(1 << 16);
    }
    bits.skip(1);
  }
  bits.skip(1);
  if (bits.flag()) {  // deblocking
    bits.skip(1);
    if (!bits.flag()) (void)bits.signed_number(6), (void)bits.signed_number(6);
  }
  if (bits.flag()) skip_scaling_lists(bits);
  p.modifies_lists = bits.flag();
  if (bits.good()) pictures_[id] = p;
}

// Returns the number of images that the slice may be predicted from, NumPicTotalCurr (7-55).
std::optional<int> HevcHeaders::count_neighbours(BitReader& bits, const Sequence& sequence) {
  bits.skip(sequence.poc_bits);
  PictureSet set;
  if (!bits.flag()) {
    const auto own = read_set(bits, sequence.sets, true);
    if (!own) return std::nullopt;
    set = *own;
  } else {
    const auto index = bits.bits(bits_for(static_cast<int>(sequence.sets.size())));
    if (index >= sequence.sets.size()) return std::nullopt;
    set = sequence.sets[index];
  }
  auto count = static_cast<int>(std::count_if(set.begin(), set.end(), [](Neighbour n) { return n.used; }));
  if (!sequence.has_long_term) return count;
  const int all_listed = static_cast<int>(sequence.long_term_used.size());
  const int listed = all_listed > 0 ? bits.number(kMaxLongTerm) : 0;
  const int more = bits.number(kMaxLongTerm);
  for (int k = 0; k < listed + more && bits.good(); ++k) {
    bool used = false;
    if (k < listed) {
      const auto index = bits.bits(bits_for(all_listed));
      used = index < sequence.long_term_used.size() && sequence.long_term_used[index];
    } else {
      bits.skip(sequence.poc_bits);
      used = bits.flag();
    }
    count += used ? 1 : 0;
    if (bits.flag()) (void)bits.number(kLargest);
  }
  return count;
}

void HevcHeaders::skip_prediction(BitReader& bits, const Picture& picture, Prediction with) {
  std::array<int, 2> references = picture.references;
  const std::size_t lists = with.both_ways ? 2 : 1;
  if (bits.flag()) {
    for (std::size_t k = 0; k < lists; ++k) references[k] = 1 + bits.number(kMaxReferences - 1);
  }
  for (std::size_t k = 0; k < lists && picture.modifies_lists && with.neighbours > 1; ++k) {
    if (bits.flag()) bits.skip(references[k] * bits_for(with.neighbours));
  }
  if (with.both_ways) bits.skip(1);
  if (picture.has_cabac_init) bits.skip(1);
  if (with.uses_vectors) {
    const bool from_first = !with.both_ways || bits.flag();
    if (references[from_first ? 0 : 1] > 1) (void)bits.number(kMaxReferences);
  }
  if (with.both_ways ? picture.weighted_both_ways : picture.weighted)
    skip_weights(bits, with.has_chroma, std::span(references).first(lists));
  (void)bits.number(4);
}

// Reads 7.3.6.1 up to slice_qp_delta.
std::optional<HevcQuantiser> HevcHeaders::read_slice(BitReader& bits, int unit_type) const {
  const bool is_first = bits.flag();
  if (unit_type >= kFirstRandomAccess && unit_type <= kLastRandomAccess) bits.skip(1);
  const auto& picture = pictures_[static_cast<std::size_t>(bits.number(static_cast<int>(pictures_.size()) - 1))];
  if (!picture || !sequences_[picture->sequence]) return std::nullopt;
  const Sequence& sequence = *sequences_[picture->sequence];
  if (!is_first) {
    if (picture->has_dependent_slices && bits.flag()) return std::nullopt;  // continues the previous slice
    bits.skip(sequence.address_bits);
  }
  bits.skip(picture->extra_bits);
  const int type = bits.number(2);
  if (picture->has_output_flag) bits.skip(1);
  if (sequence.separate_planes) bits.skip(2);
  int neighbours = 0;
  bool uses_vectors = false;
  if (unit_type != kIdr && unit_type != kIdrWithLeading) {
    const auto counted = count_neighbours(bits, sequence);
    if (!counted) return std::nullopt;
    neighbours = *counted;
    uses_vectors = sequence.has_temporal_vectors && bits.flag();
  }
  const bool has_chroma = sequence.chroma_format != 0 && !sequence.separate_planes;
  if (sequence.has_sao) bits.skip(has_chroma ? 2 : 1);
  if (type != kI) skip_prediction(bits, *picture, {type == kB, has_chroma, uses_vectors, neighbours});
  const int parameter = picture->parameter + bits.signed_number(80);
  if (!bits.good() || parameter < kMinParameter || parameter > kMaxParameterOf8Bits) return std::nullopt;
  return HevcQuantiser{parameter, picture->varies};
}

void HevcHeaders::read_unit(std::span<const std::uint8_t> unit, std::optional<HevcQuantiser>& out) {
  if (unit.size() < 3) return;
  const int type = unit[0] >> 1 & 63, layer = (unit[0] & 1) << 5 | unit[1] >> 3;
  if (layer != 0) return;
  const bool is_slice = type <= kLastSlice && (type < 10 || type >= kFirstRandomAccess);
  if (!is_slice && type != kSequenceSet && type != kPictureSet) return;
  BitReader bits(unit.subspan(2), kMaxHeaderBytes);
  if (type == kSequenceSet) return read_sequence(bits);
  if (type == kPictureSet) return read_picture(bits);
  const auto slice = read_slice(bits, type);
  if (slice && (!out || slice->parameter > out->parameter)) out = slice;
}

void HevcHeaders::read_units_behind_start_codes(std::span<const std::uint8_t> bytes,
                                                std::optional<HevcQuantiser>& out) {
  constexpr std::array<std::uint8_t, 3> kStart{0, 0, 1};
  auto at = std::search(bytes.begin(), bytes.end(), kStart.begin(), kStart.end());
  while (at != bytes.end()) {
    const auto from = at + static_cast<std::ptrdiff_t>(kStart.size());
    at = std::search(from, bytes.end(), kStart.begin(), kStart.end());
    read_unit(bytes.subspan(static_cast<std::size_t>(from - bytes.begin()), static_cast<std::size_t>(at - from)), out);
  }
}

void HevcHeaders::read_units_behind_lengths(std::span<const std::uint8_t> bytes, std::optional<HevcQuantiser>& out) {
  const auto word = static_cast<std::size_t>(length_bytes_);
  while (bytes.size() > word) {
    std::size_t length = 0;
    for (std::size_t k = 0; k < word; ++k) length = length << 8 | bytes[k];
    bytes = bytes.subspan(word);
    if (length > bytes.size()) return;
    read_unit(bytes.first(length), out);
    bytes = bytes.subspan(length);
  }
}

void HevcHeaders::read_extradata(std::span<const std::uint8_t> bytes) {
  std::optional<HevcQuantiser> none;
  length_bytes_ = 0;
  constexpr std::size_t kHead = 23;  // bytes of hvcC before its arrays
  if (bytes.size() < 4 || (bytes[0] == 0 && bytes[1] == 0 && bytes[2] <= 1))
    return read_units_behind_start_codes(bytes, none);
  if (bytes.size() < kHead) return;
  length_bytes_ = 1 + (bytes[21] & 3);
  const auto take = [&bytes](std::size_t size) {
    const auto taken = bytes.first(std::min(size, bytes.size()));
    bytes = bytes.subspan(taken.size());
    return taken;
  };
  const int arrays = bytes[22];
  take(kHead);
  for (int k = 0; k < arrays && bytes.size() >= 3; ++k) {
    const auto head = take(3);
    const int units = head[1] << 8 | head[2];
    for (int n = 0; n < units && bytes.size() >= 2; ++n) {
      const auto length = take(2);
      read_unit(take(static_cast<std::size_t>(length[0] << 8 | length[1])), none);
    }
  }
}

std::optional<HevcQuantiser> HevcHeaders::read_packet(std::span<const std::uint8_t> bytes) {
  std::optional<HevcQuantiser> out;
  if (length_bytes_ > 0)
    read_units_behind_lengths(bytes, out);
  else
    read_units_behind_start_codes(bytes, out);
  return out;
}

}  // namespace moiregauge::internal
