// SPDX-License-Identifier: Apache-2.0
// Reads the quantisers of HEVC images from the stream's headers (ITU-T H.265, 7.3), because libavcodec does not report
// them. Runs in the child only. An invalid stream gives no quantiser, never an error.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace moiregauge::internal {

class BitReader;

// SliceQpY (7-54) of the coarsest slice of an image, on the scale of 8-bit grey levels (-48 to 51).
struct HevcQuantiser {
  int parameter = 0;
  bool varies = false;  // blocks may differ from their slice (cu_qp_delta_enabled_flag)
};

class HevcHeaders {
 public:
  // Reads the parameter sets before the first packet: hvcC (ISO/IEC 14496-15) or start codes (Annex B).
  void read_extradata(std::span<const std::uint8_t> bytes);
  // Reads one packet, which is one image. Returns nothing if no slice header can be read.
  [[nodiscard]] std::optional<HevcQuantiser> read_packet(std::span<const std::uint8_t> bytes);

 private:
  // A reference image, and whether the current image uses it.
  struct Neighbour {
    int delta_poc = 0;
    bool used = false;
  };
  using PictureSet = std::vector<Neighbour>;
  struct Sequence {
    int chroma_format = 1;
    bool separate_planes = false;
    int address_bits = 0;
    int poc_bits = 4;
    std::vector<PictureSet> sets;
    bool has_long_term = false;
    std::vector<bool> long_term_used;  // for the long-term images listed in the sequence
    bool has_temporal_vectors = false;
    bool has_sao = false;
  };
  struct Picture {
    std::size_t sequence = 0;
    bool has_dependent_slices = false, has_output_flag = false, has_cabac_init = false;
    int extra_bits = 0;
    std::array<int, 2> references{1, 1};
    int parameter = 26;
    bool varies = false;
    bool weighted = false, weighted_both_ways = false;
    bool modifies_lists = false;
  };
  // Properties that determine the fields between slice start and quantiser.
  struct Prediction {
    bool both_ways = false, has_chroma = false, uses_vectors = false;
    int neighbours = 0;  // number of reference images
  };

  void read_unit(std::span<const std::uint8_t> unit, std::optional<HevcQuantiser>& out);
  void read_units_behind_start_codes(std::span<const std::uint8_t> bytes, std::optional<HevcQuantiser>& out);
  void read_units_behind_lengths(std::span<const std::uint8_t> bytes, std::optional<HevcQuantiser>& out);
  static std::optional<PictureSet> read_set(BitReader& bits, const std::vector<PictureSet>& before, bool in_slice);
  void read_sequence(BitReader& bits);
  void read_picture(BitReader& bits);
  [[nodiscard]] std::optional<HevcQuantiser> read_slice(BitReader& bits, int unit_type) const;
  static std::optional<int> count_neighbours(BitReader& bits, const Sequence& sequence);
  static void skip_prediction(BitReader& bits, const Picture& picture, Prediction with);

  std::array<std::optional<Sequence>, 16> sequences_;
  std::array<std::optional<Picture>, 64> pictures_;
  int length_bytes_ = 0;  // bytes per length field; 0: start codes
};

}  // namespace moiregauge::internal
