// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/alarm_rule.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr double kHysteresis = 0.1;  // default, share of the level (chosen)
constexpr const char* kExample = "write it like 'T1.dy > 2 mm for 0.5 s'";

bool is_name_char(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         static_cast<unsigned char>(c) >= 0x80;
}

class RuleParser {
 public:
  explicit RuleParser(std::string_view text) : text_(text) { rule_.text = std::string(text); }

  tl::expected<AlarmRule, AlarmMistake> whole() {
    if (text_.size() > kMaxAlarmText)
      return tl::unexpected(AlarmMistake{kMaxAlarmText + 1, "the alarm rule is too long", "shorten it"});
    quantity();
    comparison();
    if (const auto level = length()) rule_.level_mm = *level;
    rule_.release_mm = rule_.level_mm + (rule_.is_above ? -kHysteresis : kHysteresis) * std::fabs(rule_.level_mm);
    if (take_word("for")) duration();
    if (take_word("until")) release();
    skip_spaces();
    if (at_ < text_.size())
      fail(at_, "the alarm rule has more text", "end it after the level, 'for TIME' and 'until LENGTH'");
    if (mistake_) return tl::unexpected(*mistake_);
    return rule_;
  }

 private:
  // Keeps the first mistake.
  void fail(std::size_t at, std::string what, std::string remedy) {
    if (!mistake_) mistake_ = AlarmMistake{at + 1, std::move(what), std::move(remedy)};
  }
  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool take(char c) {
    skip_spaces();
    if (mistake_ || at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  bool take_word(std::string_view word) {
    skip_spaces();
    if (mistake_ || text_.substr(at_, word.size()) != word) return false;
    const std::size_t end = at_ + word.size();
    if (end < text_.size() && is_name_char(text_[end])) return false;
    at_ = end;
    return true;
  }

  void quantity() {
    rule_.is_absolute = take('|');
    skip_spaces();
    const std::size_t start = at_;
    if (take('"')) {
      const std::size_t end = text_.find('"', at_);
      if (end == std::string_view::npos)
        return fail(start, "the marker's name has no closing quote", "close it with \"");
      rule_.marker = text_.substr(at_, end - at_);
      at_ = end + 1;
    } else {
      while (at_ < text_.size() && is_name_char(text_[at_])) ++at_;
      rule_.marker = text_.substr(start, at_ - start);
    }
    if (rule_.marker.empty()) return fail(start, "the alarm rule names no marker", kExample);
    if (!take('.')) return fail(at_, fmt::format("no quantity of '{}' is named", rule_.marker), "add .dx or .dy");
    if (take_word("dx"))
      rule_.is_y = false;
    else if (!take_word("dy"))
      return fail(at_, "the quantity is neither dx nor dy", "write dx or dy after the point");
    if (rule_.is_absolute && !take('|')) fail(at_, "the absolute value has no end", "close it with |");
  }

  void comparison() {
    skip_spaces();
    if (take('>')) return;
    if (take('<')) {
      rule_.is_above = false;
      return;
    }
    fail(at_, "the comparison is neither > nor <", kExample);
  }

  std::optional<double> number() {
    skip_spaces();
    if (mistake_) return std::nullopt;
    double value = 0.0;
    const auto [end, problem] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (problem != std::errc() || !std::isfinite(value)) {
      fail(at_, "a number is missing", kExample);
      return std::nullopt;
    }
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }

  // Reads a number and one of the units, which are divisors: 1000 is exact in binary and 0.001 is not.
  template <std::size_t N>
  std::optional<double> measure(const std::array<std::pair<std::string_view, double>, N>& units, const char* remedy) {
    const auto value = number();
    if (!value) return std::nullopt;
    for (const auto& [unit, over] : units) {
      if (!take_word(unit)) continue;
      if (std::isfinite(*value / over)) return *value / over;
      fail(at_, "the number is too large", "give a smaller one");
      return std::nullopt;
    }
    fail(at_, "the number has no known unit", remedy);
    return std::nullopt;
  }

  std::optional<double> length() {
    constexpr std::array<std::pair<std::string_view, double>, 5> kUnits{
        {{"mm", 1.0}, {"cm", 0.1}, {"m", 0.001}, {"um", 1000.0}, {"in", 1.0 / 25.4}}};
    return measure(kUnits, "write mm, cm, m, um or in after it");
  }

  void duration() {
    constexpr std::array<std::pair<std::string_view, double>, 3> kUnits{{{"s", 1.0}, {"ms", 1e3}, {"min", 1.0 / 60.0}}};
    skip_spaces();
    const std::size_t start = at_;
    const auto time = measure(kUnits, "write s, ms or min after it");
    if (time && *time < 0.0) fail(start, "the duration is negative", "give 0 s or more");
    if (time) rule_.duration_s = *time;
  }

  void release() {
    skip_spaces();
    const std::size_t start = at_;
    const auto level = length();
    if (!level) return;
    rule_.release_mm = *level;
    const bool is_safe = rule_.is_above ? *level <= rule_.level_mm : *level >= rule_.level_mm;
    if (!is_safe)
      fail(start, "the alarm would clear where it is raised", "give a level after 'until' on the safe side");
  }

  std::string_view text_;
  std::size_t at_ = 0;
  AlarmRule rule_;
  std::optional<AlarmMistake> mistake_;
};

}  // namespace

tl::expected<AlarmRule, AlarmMistake> parse_alarm_rule(std::string_view text) { return RuleParser(text).whole(); }

}  // namespace moiregauge::internal
