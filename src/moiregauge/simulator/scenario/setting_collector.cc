// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/scenario/setting_collector.h"

#include <cstdlib>

namespace moiregauge::internal::simulator {

std::optional<std::vector<double>> numbers_in(std::string text) {
  for (char& c : text) {
    if (c == '[' || c == ']' || c == ',') c = ' ';
  }
  std::vector<double> numbers;
  const char* at = text.c_str();
  while (true) {
    while (*at == ' ') ++at;
    if (*at == '\0') return numbers;
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    if (end == at || (*end != ' ' && *end != '\0') || !std::isfinite(numbers.back())) return std::nullopt;
    at = end;
  }
}

std::optional<double> number_in(const std::string& text) {
  const auto numbers = numbers_in(text);
  return numbers && numbers->size() == 1 ? std::optional(numbers->front()) : std::nullopt;
}

void Collector::number(const std::string& name, double& value) {
  number(name, [&value](double read) { value = read; });
}

void Collector::number(const std::string& name, const std::function<void(double)>& take) {
  text(name, "a number", [take](const std::string& words) {
    const auto read = number_in(words);
    if (read) take(*read);
    return read.has_value();
  });
}

void Collector::flag(const std::string& name, const std::vector<bool*>& values) {
  text(name, "true or false", [values](const std::string& word) {
    if (word != "true" && word != "false") return false;
    for (bool* value : values) *value = word == "true";
    return true;
  });
}

void Collector::pair(const std::string& name, const std::function<void(double, double)>& take) {
  text(name, "two numbers", [take](const std::string& words) {
    const auto read = numbers_in(words);
    if (!read || read->size() != 2) return false;
    take((*read)[0], (*read)[1]);
    return true;
  });
}

void Collector::text(const std::string& name, const std::string& kind, std::function<bool(const std::string&)> take) {
  settings.push_back({name, kind, std::move(take)});
}

void Collector::frames(const std::string& name, std::vector<FrameSpan>& spans) {
  text(name, "pairs of whole numbers (first frame, and the frame after the last)", [&spans](const std::string& words) {
    const auto read = numbers_in(words);
    if (!read || read->size() % 2 != 0) return false;
    std::vector<FrameSpan> taken;
    for (std::size_t i = 0; i < read->size(); i += 2) {
      const double from = (*read)[i], to = (*read)[i + 1];
      if (from < 0.0 || to < from || to > 2e9 || from != std::floor(from) || to != std::floor(to)) return false;
      taken.push_back({static_cast<long>(from), static_cast<long>(to)});
    }
    spans = taken;
    return true;
  });
}

void Collector::track(const std::string& name, Track& track) {
  number(name, track.offset);
  number(name + ".scale", track.scale);
  number(name + ".offset", track.offset);
  number(name + ".amplitude", track.amplitude);
  number(name + ".frequency_hz", track.frequency_hz);
  number(name + ".phase_deg", track.phase_deg);
  number(name + ".random", track.random);
  number(name + ".random_step_s", track.random_step_s);
  whole(name + ".random_seed", track.random_seed);
  text(name + ".knots", "pairs of time and value, with increasing times", [&track](const std::string& words) {
    const auto read = numbers_in(words);
    if (!read || read->size() % 2 != 0) return false;
    std::vector<Knot> knots;
    for (std::size_t i = 0; i < read->size(); i += 2) {
      if (!knots.empty() && (*read)[i] <= knots.back().time_s) return false;
      knots.push_back({(*read)[i], (*read)[i + 1]});
    }
    track.knots = knots;
    return true;
  });
}

}  // namespace moiregauge::internal::simulator
