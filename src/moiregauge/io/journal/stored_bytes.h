// SPDX-License-Identifier: Apache-2.0
// Stores values as bytes: little-endian, doubles by their bits, a count before lists. Three archives share one
// description of every type (stored_values.h): a writer, a reader, and a speller of the layout.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

namespace moiregauge::internal {

template <typename Number>
using BitsOf = std::conditional_t<sizeof(Number) == 8, std::uint64_t, std::uint32_t>;

template <typename Number>
[[nodiscard]] std::uint64_t bits_of(Number value) {
  return std::bit_cast<BitsOf<Number>>(value);
}

inline void append_little_endian(std::string& bytes, std::uint64_t value, int size) {
  for (int k = 0; k < size; ++k) bytes += static_cast<char>(static_cast<std::uint8_t>(value >> (8 * k)));
}

[[nodiscard]] inline std::uint64_t from_little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t k = bytes.size(); k-- > 0;) value = value << 8U | static_cast<std::uint8_t>(bytes[k]);
  return value;
}

// `long` has 64 bits and `int` 32 on all supported machines, as the file format requires.
template <typename Number>
inline constexpr bool kStorable = std::is_same_v<Number, int> || std::is_same_v<Number, double> ||
                                  ((std::is_same_v<Number, long> ||
                                    std::is_same_v<Number, std::size_t>)&&sizeof(Number) == 8);

// Fields `first` to `first + count - 1` of a struct exist since version `since` of the layout.
struct AddedFields {
  std::size_t first = 0, count = 0;
  int since = 0;
};
template <typename Struct>
inline constexpr std::array<AddedFields, 2> kAdded{};

// Returns the layout version of an archive. An archive without one has the newest.
template <typename Archive>
[[nodiscard]] int version_of(const Archive& archive) {
  if constexpr (requires { archive.version(); })
    return archive.version();
  else
    return std::numeric_limits<int>::max();
}

class ByteWriter {
 public:
  static constexpr bool kReads = false;
  template <typename Number>
  void number(const Number& value) {
    static_assert(kStorable<Number>);
    append_little_endian(bytes_, bits_of(value), sizeof(Number));
  }
  [[nodiscard]] bool flag(bool value) {
    bytes_ += static_cast<char>(value);
    return value;
  }
  [[nodiscard]] std::size_t count(std::size_t n) {
    append_little_endian(bytes_, n, 4);
    return n;
  }
  void text(const std::string& value) {
    (void)count(value.size());
    bytes_ += value;
  }
  [[nodiscard]] static bool good() { return true; }
  void fail() {}
  void open() {}
  void close() {}
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Reads bytes. After the first missing or invalid value it returns zeros and empty values.
class ByteReader {
 public:
  static constexpr bool kReads = true;
  ByteReader(std::string_view bytes, int version) : left_(bytes), version_(version) {}
  [[nodiscard]] int version() const { return version_; }
  template <typename Number>
  void number(Number& value) {
    static_assert(kStorable<Number>);
    value = std::bit_cast<Number>(static_cast<BitsOf<Number>>(from_little_endian(take(sizeof(Number)))));
  }
  [[nodiscard]] bool flag(bool) {
    const auto byte = from_little_endian(take(1));
    if (byte > 1) fail();
    return good_ && byte == 1;
  }
  // Returns a count, at most the number of bytes left, because every counted element has at least one byte.
  [[nodiscard]] std::size_t count(std::size_t) {
    const auto n = static_cast<std::size_t>(from_little_endian(take(4)));
    if (n > left_.size()) fail();
    return good_ ? n : 0;
  }
  void text(std::string& value) { value = std::string(take(count(0))); }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool is_finished() const { return good_ && left_.empty(); }
  void fail() {
    good_ = false;
    left_ = {};
  }
  void open() {}
  void close() {}

 private:
  std::string_view take(std::size_t n) {
    if (n > left_.size()) fail();
    if (!good_) return {};
    const std::string_view taken = left_.substr(0, n);
    left_.remove_prefix(n);
    return taken;
  }
  std::string_view left_;
  int version_;
  bool good_ = true;
};

// Spells the layout of a type with one letter per value. Program versions with different structs have different
// spellings.
class LayoutSpeller {
 public:
  static constexpr bool kReads = true;
  explicit LayoutSpeller(int version) : version_(version) {}
  [[nodiscard]] int version() const { return version_; }
  template <typename Number>
  void number(Number&) {
    static_assert(kStorable<Number>);
    spelling_ += std::is_same_v<Number, double> ? 'd' : sizeof(Number) == 4 ? 'i' : 'l';
  }
  [[nodiscard]] bool flag(bool) {
    spelling_ += 'f';
    return true;
  }
  [[nodiscard]] std::size_t count(std::size_t) {
    spelling_ += 'n';
    return 1;
  }
  void text(std::string&) { spelling_ += 's'; }
  [[nodiscard]] static bool good() { return true; }
  void fail() {}
  void open() { spelling_ += '('; }
  void close() { spelling_ += ')'; }
  void word(std::string_view text) { spelling_ += text; }
  [[nodiscard]] const std::string& spelling() const { return spelling_; }

 private:
  int version_;
  std::string spelling_;
};

}  // namespace moiregauge::internal
