// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/channel_parser.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxUnit = 16;  // bytes

using Mistake = tl::unexpected<ChannelMistake>;

Mistake mistake(std::size_t at, std::string what, std::string remedy) {
  return Mistake(ChannelMistake{at + 1, std::move(what), std::move(remedy)});
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

// Intermediate result: a number, or a combination of terms with a unit.
struct Linear {
  std::vector<ChannelTerm> terms;
  double constant = 0.0;
  std::string unit;
  [[nodiscard]] bool is_number() const { return terms.empty(); }
};

void scale(Linear& a, double factor) {
  a.constant *= factor;
  for (ChannelTerm& term : a.terms) term.factor *= factor;
}

bool is_finite(const Linear& a) {
  return std::isfinite(a.constant) && std::all_of(a.terms.begin(), a.terms.end(),
                                                  [](const ChannelTerm& term) { return std::isfinite(term.factor); });
}

// Adds `more` to `sum`; equal terms are merged.
void add(Linear& sum, Linear more) {
  sum.constant += more.constant;
  if (sum.unit.empty()) sum.unit = more.unit;
  for (ChannelTerm& term : more.terms) {
    const auto same = std::find_if(sum.terms.begin(), sum.terms.end(), [&](const ChannelTerm& other) {
      return other.kind == term.kind && other.targets == term.targets;
    });
    if (same == sum.terms.end())
      sum.terms.push_back(std::move(term));
    else
      same->factor += term.factor;
  }
}

struct FunctionOfTargets {
  const char* name;
  TermKind kind;
  const char* unit;
  std::size_t min_targets, max_targets;
};
constexpr std::array kFunctions{
    FunctionOfTargets{"chord", TermKind::kChord, "mm", 2, 2},
    FunctionOfTargets{"sag", TermKind::kSag, "mm", 3, 3},
    FunctionOfTargets{"rotation", TermKind::kLineRotation, "mrad", 2, 64},
    FunctionOfTargets{"strain", TermKind::kStrain, "um/m", 2, 2},
};

struct QuantityOfTarget {
  const char* name;
  TermKind kind;
  const char* unit;
};
constexpr std::array kOfOneTarget{QuantityOfTarget{"dx", TermKind::kDx, "mm"},
                                  QuantityOfTarget{"dy", TermKind::kDy, "mm"},
                                  QuantityOfTarget{"rotation", TermKind::kRotation, "mrad"}};

// Recursive descent over the text. The first mistake ends it.
class ExpressionParser {
 public:
  using Result = tl::expected<Linear, ChannelMistake>;
  ExpressionParser(std::string_view text, std::size_t from, std::span<const std::string> targets,
                   std::span<const Channel> earlier, bool has_stated_unit)
      : text_(text), at_(from), targets_(targets), earlier_(earlier), has_stated_unit_(has_stated_unit) {}

  Result whole() {
    auto value = sum();
    if (!value) return value;
    if (!is_at_end()) return mistake(at_, "the expression has more text than one value", "write an operator here");
    return value;
  }

  [[nodiscard]] const std::vector<NamedTarget>& named() const { return named_; }

 private:
  struct Name {
    std::string text;
    std::size_t at = 0, end = 0;
    bool is_quoted = false;
  };

  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool is_at_end() {
    skip_spaces();
    return at_ >= text_.size();
  }
  [[nodiscard]] char here() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  bool take(char c) {
    skip_spaces();
    if (here() != c || at_ >= text_.size()) return false;
    ++at_;
    return true;
  }

  Result sum() {
    auto value = product();
    while (value) {
      skip_spaces();
      const std::size_t at = at_;
      const double sign = take('+') ? 1.0 : take('-') ? -1.0 : 0.0;
      if (sign == 0.0) return value;
      auto more = product();
      if (!more) return more;
      const bool is_other = !value->unit.empty() && !more->unit.empty() && value->unit != more->unit;
      if (is_other && !has_stated_unit_)
        return mistake(at, fmt::format("a sum has two units, {} and {}", value->unit, more->unit),
                       "scale one of them and state the unit, as in NAME [UNIT] = ...");
      scale(*more, sign);
      add(*value, *std::move(more));
      if (value->terms.size() > kMaxChannelTerms)
        return mistake(at, fmt::format("the channel has more than {} terms", kMaxChannelTerms), "divide it in two");
    }
    return value;
  }

  Result product() {
    auto value = factor();
    while (value) {
      skip_spaces();
      const std::size_t at = at_;
      const bool is_quotient = take('/');
      if (!is_quotient && !take('*')) return value;
      auto more = factor();
      if (!more) return more;
      if (is_quotient && !more->is_number())
        return mistake(at, "a channel is divided by another one, which is not linear", "divide by a number only");
      if (!value->is_number() && !more->is_number())
        return mistake(at, "two channels are multiplied, which is not linear", "multiply by a number only");
      if (is_quotient && more->constant == 0.0) return mistake(at, "a value is divided by zero", "give another number");
      if (!is_quotient && value->is_number()) std::swap(*value, *more);
      scale(*value, is_quotient ? 1.0 / more->constant : more->constant);
      if (!is_finite(*value)) return mistake(at, "a number is too large", "give a smaller one");
    }
    return value;
  }
  Result factor() {
    if (++depth_ > kMaxChannelDepth)
      return mistake(at_, fmt::format("brackets and signs are nested more than {} deep", kMaxChannelDepth),
                     "write a simpler expression");
    auto value = take('-') ? negated(factor()) : take('+') ? factor() : primary();
    --depth_;
    return value;
  }
  static Result negated(Result value) {
    if (value) scale(*value, -1.0);
    return value;
  }

  Result primary() {
    if (is_at_end())
      return mistake(at_, "the expression ends too early", "write a number, a target or a function here");
    if (take('(')) return closed(sum());
    if (is_digit(here()) || here() == '.') return number();
    const auto name = take_name();
    if (!name) return tl::unexpected(name.error());
    if (here() == '.') return of_target(*name);
    if (!name->is_quoted && take('(')) return function(*name);
    return earlier_channel(*name);
  }
  Result closed(Result value) {
    if (!value) return value;
    if (!take(')')) return mistake(at_, "a bracket is not closed", "write ) here");
    return value;
  }

  Result number() {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value))
      return mistake(at_, "a number cannot be read", "write it as in 0.5 or 2e-3");
    at_ = static_cast<std::size_t>(end - text_.data());
    return Linear{{}, value, {}};
  }

  tl::expected<Name, ChannelMistake> take_name() {
    skip_spaces();
    Name name{{}, at_, 0, here() == '\'' || here() == '"'};
    if (name.is_quoted) {
      const auto end = text_.find(here(), at_ + 1);
      if (end == std::string_view::npos) return mistake(at_, "a quoted name does not end", "write the second quote");
      name.text = text_.substr(at_ + 1, end - at_ - 1);
      at_ = name.end = end + 1;
      return name;
    }
    if (!is_letter(here()))
      return mistake(at_, "a value is missing here", "write a number, a target such as mid.dy, or a function");
    while (at_ < text_.size() && (is_letter(here()) || is_digit(here()))) name.text += text_[at_++];
    name.end = at_;
    return name;
  }

  tl::expected<std::size_t, ChannelMistake> target(const Name& name) {
    const auto found = std::find(targets_.begin(), targets_.end(), name.text);
    if (found == targets_.end())
      return mistake(name.at, "no target has the name " + shown(name.text),
                     fmt::format("use one of {} (put other characters than letters and digits in quotes)",
                                 fmt::join(targets_.first(std::min<std::size_t>(targets_.size(), 12)), ", ")));
    const auto index = static_cast<std::size_t>(found - targets_.begin());
    named_.push_back({name.at, name.end - name.at, index});
    return index;
  }
  // Control characters of hostile text stay out of messages.
  static std::string shown(const std::string& name) {
    std::string text = "'";
    for (const char c : name.substr(0, 64)) text += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
    return text + "'";
  }

  Result of_target(const Name& name) {
    ++at_;
    const auto found = target(name);
    if (!found) return tl::unexpected(found.error());
    const std::size_t at = at_;
    std::string quantity;
    while (at_ < text_.size() && is_letter(here())) quantity += text_[at_++];
    for (const QuantityOfTarget& known : kOfOneTarget) {
      if (quantity == known.name) return Linear{{{known.kind, {*found}, 1.0}}, 0.0, known.unit};
    }
    return mistake(at, "a target has no quantity " + shown(quantity), "use dx, dy or rotation");
  }

  Result function(const Name& name) {
    if (name.text == "mean") return mean();
    for (const FunctionOfTargets& known : kFunctions) {
      if (name.text == known.name) return function_of_targets(known, name.at);
    }
    return mistake(name.at, "there is no function " + shown(name.text), "use mean, chord, sag, rotation or strain");
  }
  Result mean() {
    Linear total;
    double count = 0.0;
    do {
      const std::size_t at = at_;
      auto value = sum();
      if (!value) return value;
      if (!total.unit.empty() && !value->unit.empty() && total.unit != value->unit && !has_stated_unit_)
        return mistake(at, fmt::format("a mean has two units, {} and {}", total.unit, value->unit),
                       "scale one of them and state the unit, as in NAME [UNIT] = ...");
      add(total, *std::move(value));
      if (total.terms.size() > kMaxChannelTerms)
        return mistake(at, fmt::format("the channel has more than {} terms", kMaxChannelTerms), "divide it in two");
      count += 1.0;
    } while (take(','));
    scale(total, 1.0 / count);
    return closed(std::move(total));
  }
  Result function_of_targets(const FunctionOfTargets& of, std::size_t at) {
    ChannelTerm term{of.kind, {}, 1.0};
    do {
      const auto name = take_name();
      if (!name) return tl::unexpected(name.error());
      const auto found = target(*name);
      if (!found) return tl::unexpected(found.error());
      if (std::find(term.targets.begin(), term.targets.end(), *found) != term.targets.end())
        return mistake(name->at, fmt::format("{} has the target {} twice", of.name, shown(name->text)),
                       "name different targets");
      term.targets.push_back(*found);
    } while (term.targets.size() < of.max_targets && take(','));
    if (term.targets.size() < of.min_targets)
      return mistake(at, fmt::format("{} has {} targets, it needs {}", of.name, term.targets.size(), of.min_targets),
                     "name the targets with commas between them");
    return closed(Linear{{std::move(term)}, 0.0, of.unit});
  }

  Result earlier_channel(const Name& name) {
    for (const Channel& channel : earlier_) {
      if (channel.name == name.text) return Linear{channel.terms, channel.constant, channel.unit};
    }
    const bool is_target = std::find(targets_.begin(), targets_.end(), name.text) != targets_.end();
    if (is_target)
      return mistake(at_, "a target is named without a quantity", "write .dx, .dy or .rotation after the name");
    return mistake(name.at, "no earlier channel has the name " + shown(name.text),
                   "define it before, or name a target with .dx, .dy or .rotation");
  }

  std::string_view text_;
  std::size_t at_;
  std::span<const std::string> targets_;
  std::span<const Channel> earlier_;
  bool has_stated_unit_;
  int depth_ = 0;
  std::vector<NamedTarget> named_;
};

bool is_unit(std::string_view unit) {
  return !unit.empty() && unit.size() <= kMaxUnit && std::all_of(unit.begin(), unit.end(), [](char c) {
    return is_digit(c) || (is_letter(c) && static_cast<unsigned char>(c) < 0x80) || c == '/' || c == '^';
  });
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Reads the expression that starts at `from`.
tl::expected<Channel, ChannelMistake> channel_from(std::string_view text, std::size_t from, Channel channel,
                                                   std::span<const std::string> targets,
                                                   std::span<const Channel> earlier) {
  if (text.size() > kMaxChannelText)
    return mistake(kMaxChannelText, fmt::format("the channel has more than {} bytes", kMaxChannelText),
                   "write a shorter expression");
  if (const std::string problem = channel_name_problem(channel.name); !problem.empty())
    return mistake(0, problem, "begin with a letter, then use letters, digits and _");
  if (std::any_of(earlier.begin(), earlier.end(), [&](const Channel& other) { return other.name == channel.name; }))
    return mistake(0, fmt::format("a channel named '{}' already exists", channel.name), "give it another name");
  auto value = ExpressionParser(text, from, targets, earlier, !channel.unit.empty()).whole();
  if (!value) return tl::unexpected(value.error());
  if (value->is_number())
    return mistake(from, "the channel contains no target", "write an expression such as mid.dy - left.dy");
  if (channel.unit.empty()) channel.unit = value->unit;
  channel.terms = std::move(value->terms);
  channel.constant = value->constant;
  channel.text = trimmed(text.substr(from));
  return channel;
}

}  // namespace

std::string_view name_in_channel(std::string_view text) {
  const std::string_view left = text.substr(0, text.find('='));
  return trimmed(left.substr(0, left.find('[')));
}

std::string channel_unit_problem(std::string_view unit) {
  return is_unit(unit) ? std::string() : std::string("the unit cannot be read");
}

std::string channel_name_problem(std::string_view name) {
  const auto is_part = [](char c) { return is_letter(c) || is_digit(c); };
  const bool is_plain =
      !name.empty() && name.size() <= 64 && is_letter(name.front()) && std::all_of(name.begin(), name.end(), is_part);
  return is_plain ? std::string() : std::string("the channel has no proper name");
}

tl::expected<Channel, ChannelMistake> parse_channel(std::string_view text, std::span<const std::string> targets,
                                                    std::span<const Channel> earlier) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos)
    return mistake(std::min(text.size(), kMaxChannelText), "the channel has no name", "write NAME = EXPRESSION");
  std::string_view name = trimmed(text.substr(0, equals));
  Channel channel;
  if (!name.empty() && name.back() == ']') {
    const auto open = name.find('[');
    const std::string_view unit =
        open == std::string_view::npos ? std::string_view() : trimmed(name.substr(open + 1, name.size() - open - 2));
    if (!is_unit(unit))
      return mistake(open == std::string_view::npos ? 0 : open, "the unit cannot be read",
                     "write up to 16 letters, digits, / and ^ between [ and ]");
    channel.unit = unit;
    name = trimmed(name.substr(0, open));
  }
  channel.name = name;
  return channel_from(text, equals + 1, std::move(channel), targets, earlier);
}

tl::expected<Channel, ChannelMistake> parse_channel_value(const std::string& name, const std::string& unit,
                                                          std::string_view text, std::span<const std::string> targets,
                                                          std::span<const Channel> earlier) {
  if (!unit.empty() && !is_unit(unit))
    return mistake(0, channel_unit_problem(unit), "write up to 16 letters, digits, / and ^");
  return channel_from(text, 0, Channel{name, unit, {}, 0.0, {}}, targets, earlier);
}

tl::expected<std::vector<NamedTarget>, ChannelMistake> targets_named_in(std::string_view text,
                                                                        std::span<const std::string> targets,
                                                                        std::span<const Channel> earlier) {
  ExpressionParser parser(text, 0, targets, earlier, /*has_stated_unit=*/true);
  if (const auto value = parser.whole(); !value) return tl::unexpected(value.error());
  return parser.named();
}

}  // namespace moiregauge::internal
