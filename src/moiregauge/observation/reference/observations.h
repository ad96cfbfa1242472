// SPDX-License-Identifier: Apache-2.0
// Observations of a run, packed. One frame is unpacked at a time, so that an hour of frames fits into memory.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/observation/reference/packed_observation.h"

namespace moiregauge::internal {

class Observations {
 public:
  Observations() = default;
  explicit Observations(const Reference& reference) : packing_(reference) {}
  Observations(std::initializer_list<Observation> frames) {
    for (const Observation& seen : frames) push_back(seen);
  }
  // Sets the reference frame of the packing. No frame added before may contain points.
  void refer_to(const Reference& reference) { packing_ = ObservationPacking(reference); }

  // Packs a frame and adds it.
  void push_back(const Observation& seen) { packed_.push_back(packing_.packed(seen)); }
  // Adds bytes that were unpacked once.
  void push_back_packed(std::string bytes) { packed_.push_back(std::move(bytes)); }
  [[nodiscard]] std::string packed(const Observation& seen) const { return packing_.packed(seen); }
  // Returns the observation in `bytes`.
  // Fails (nothing): the bytes are not an observation.
  [[nodiscard]] std::optional<Observation> unpacked(const std::string& bytes) const { return packing_.unpacked(bytes); }
  void replace(std::size_t n, const Observation& seen) { packed_[n] = packing_.packed(seen); }
  void clear() { packed_.clear(); }
  // Adds frames [first, end) of `other`, which were packed against the same reference frame.
  void append(const Observations& other, std::size_t first, std::size_t end);
  // Returns the observation as it will be read later: packed and unpacked.
  [[nodiscard]] Observation rounded(const Observation& seen) const { return read(packing_.packed(seen)); }

  [[nodiscard]] std::size_t size() const { return packed_.size(); }
  [[nodiscard]] bool empty() const { return packed_.empty(); }
  [[nodiscard]] Observation operator[](std::size_t n) const { return read(packed_[n]); }
  [[nodiscard]] Observation front() const { return (*this)[0]; }
  [[nodiscard]] Observation back() const { return (*this)[size() - 1]; }
  [[nodiscard]] const std::string& packed(std::size_t n) const { return packed_[n]; }

  // Iterates over frames by value.
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Observation;
    using difference_type = std::ptrdiff_t;
    using pointer = const Observation*;
    using reference = Observation;
    Iterator(const Observations& all, std::size_t n) : all_(&all), n_(n) {}
    Observation operator*() const { return (*all_)[n_]; }
    Iterator& operator++() {
      ++n_;
      return *this;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) { return a.n_ == b.n_; }

   private:
    const Observations* all_;
    std::size_t n_;
  };
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size()}; }

 private:
  [[nodiscard]] Observation read(const std::string& bytes) const;
  ObservationPacking packing_;
  std::vector<std::string> packed_;
};

}  // namespace moiregauge::internal
