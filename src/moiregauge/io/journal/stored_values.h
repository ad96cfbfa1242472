// SPDX-License-Identifier: Apache-2.0
// Describes how values of any type are stored, for reading and writing (archives: stored_bytes.h).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/io/journal/fields.h"
#include "moiregauge/io/journal/stored_bytes.h"

namespace moiregauge::internal {

template <typename Archive, typename Value>
void store(Archive& archive, Value& value);

// Stores a field by its index. A field that the archive's version does not have stays unchanged.
template <typename Struct, typename Archive, typename Value>
void store_since(Archive& archive, Value& value, std::size_t place) {
  for (const AddedFields& added : kAdded<Struct>) {
    const bool is_new = place >= added.first && place < added.first + added.count;
    if (is_new && version_of(archive) < added.since) return;
  }
  store(archive, value);
}

// Rule for a class that is not stored field by field. Specialised below and in run_layout.h.
template <typename Value>
struct Stored;

template <typename Value>
concept HasRule = requires {
  sizeof(Stored<Value>);
};

// Stores a value. `is_known` checks the values of a stored enumeration.
template <typename Archive, typename Value>
void store(Archive& archive, Value& value) {
  using Plain = std::remove_const_t<Value>;
  if constexpr (std::is_same_v<Plain, bool>) {
    const bool there = archive.flag(value);
    if constexpr (Archive::kReads) value = there;
  } else if constexpr (std::is_enum_v<Plain>) {
    static_assert(std::is_same_v<std::underlying_type_t<Plain>, int>);
    int number = static_cast<int>(value);
    archive.number(number);
    if (!is_known(static_cast<Plain>(number))) return archive.fail();
    if constexpr (Archive::kReads) value = static_cast<Plain>(number);
  } else if constexpr (std::is_arithmetic_v<Plain>) {
    archive.number(value);
  } else if constexpr (std::is_same_v<Plain, std::string>) {
    archive.text(value);
  } else if constexpr (HasRule<Plain>) {
    Stored<Plain>::store(archive, value);
  } else {
    archive.open();
    std::size_t place = 0;
    std::apply([&](auto&... field) { (store_since<Plain>(archive, field, place++), ...); }, fields_of(value));
    archive.close();
  }
}

template <typename Element>
struct Stored<std::optional<Element>> {
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    const bool there = archive.flag(value.has_value());
    if constexpr (Archive::kReads) {
      value.reset();
      if (there) value.emplace();
    }
    if (there) moiregauge::internal::store(archive, *value);
  }
};

template <typename Element>
struct Stored<std::vector<Element>> {
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    const std::size_t count = archive.count(value.size());
    if constexpr (Archive::kReads) value.clear();
    // Grows element by element, so a false count allocates no memory.
    for (std::size_t k = 0; k < count && archive.good(); ++k) {
      if constexpr (Archive::kReads) value.emplace_back();
      moiregauge::internal::store(archive, value[k]);
    }
  }
};

template <typename Element, std::size_t kSize>
struct Stored<std::array<Element, kSize>> {
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    for (auto& element : value) moiregauge::internal::store(archive, element);
  }
};

// Fixed size, row by row.
template <int kRows, int kColumns>
struct Stored<Eigen::Matrix<double, kRows, kColumns>> {
  static_assert(kRows > 0 && kColumns > 0);
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) archive.number(value(row, column));
    }
  }
};

}  // namespace moiregauge::internal
