// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/open_publishers.h"

#include <charconv>
#include <cstdlib>

#include <fmt/format.h>

#include "moiregauge/live/publish/alarm_publisher.h"
#include "moiregauge/live/publish/influx_sender.h"
#include "moiregauge/live/publish/metrics_publisher.h"
#include "moiregauge/live/publish/mqtt_sender.h"

namespace moiregauge::internal {
namespace {

using Mistake = tl::unexpected<std::string>;
using Outlets = std::vector<std::unique_ptr<BlockOutlet>>;

constexpr std::string_view kInfluxFile = "influx:", kInfluxHttp = "influx+";

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// Turns "what: remedy" into "what: where: remedy".
Mistake mistake(const std::string& what_and_remedy, const std::string& where) {
  const std::size_t colon = what_and_remedy.find(": ");
  return Mistake(fmt::format("{}: {}: {}", what_and_remedy.substr(0, colon), where, what_and_remedy.substr(colon + 2)));
}

tl::expected<std::unique_ptr<BlockOutlet>, std::string> open_outlet(const std::string& text, const PublishArgs& args) {
  const std::string where = "--publish " + text;
  if (text.starts_with(kInfluxFile)) {
    const std::string path = text.substr(kInfluxFile.size());
    if (path.empty()) return mistake("the outlet names no file: write it like influx:rows.lp", where);
    return block_outlet("influx", influx_file_sender(path));
  }
  const bool is_influx = text.starts_with(kInfluxHttp);
  auto url = parse_outlet_url(is_influx ? std::string_view(text).substr(kInfluxHttp.size()) : text);
  if (!url) return mistake(url.error(), is_influx ? "--publish influx+..." : "--publish");
  if (is_influx && (url->scheme == "http" || url->scheme == "https"))
    return block_outlet("influx", influx_http_sender(*url, environment("MOIREGAUGE_TOKEN")));
  if (is_influx || (url->scheme != "mqtt" && url->scheme != "mqtts"))
    return mistake(
        fmt::format(
            "the outlet '{}' is unknown: give mqtt://, mqtts://, influx:FILE, influx+http:// or influx+https://",
            url->scheme),
        where);
  const bool has_topic = url->path.size() > 1 && url->path.find_first_of("#+") == std::string::npos;
  if (!has_topic)
    return mistake("the address has no topic: write it like mqtt://HOST/bridge/span2, without # and +", where);
  if (url->path.ends_with('/')) url->path.pop_back();
  return block_outlet("mqtt", mqtt_sender({*url, environment("MOIREGAUGE_PASSWORD"), args.mqtt_ca}));
}

struct ListenAddress {
  std::string host = "127.0.0.1";
  int port = 0;
};

tl::expected<ListenAddress, std::string> listen_address(const std::string& text) {
  const std::string where = "--listen " + text;
  ListenAddress address;
  const std::size_t colon = text.rfind(':');
  std::string_view port = text;
  if (colon != std::string::npos) {
    address.host = text.substr(0, colon);
    if (address.host.starts_with('[') && address.host.ends_with(']'))
      address.host = address.host.substr(1, address.host.size() - 2);
    port.remove_prefix(colon + 1);
  }
  const auto [end, problem] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (problem != std::errc() || end != port.data() + port.size() || address.port < 0 || address.port > 65535)
    return mistake("the address has no port: write it like 127.0.0.1:9464", where);
  if (!is_loopback(address.host))
    return mistake(
        "other computers could reach the page: give 127.0.0.1, and forward the port with ssh or a reverse proxy",
        where);
  return address;
}

tl::expected<std::vector<AlarmRule>, std::string> read_rules(const std::vector<std::string>& texts) {
  std::vector<AlarmRule> rules;
  for (const std::string& text : texts) {
    auto rule = parse_alarm_rule(text);
    if (!rule)
      return Mistake(fmt::format("{}: --alarm '{}', column {}: {}", rule.error().what, text.substr(0, 80),
                                 rule.error().column, rule.error().remedy));
    rules.push_back(std::move(*rule));
  }
  return rules;
}

}  // namespace

tl::expected<Publishers, std::string> open_publishers(const PublishArgs& args) {
  const auto rules = read_rules(args.alarms);
  if (!rules) return Mistake(rules.error());
  std::optional<ListenAddress> address;
  if (!args.listen.empty()) {
    const auto read = listen_address(args.listen);
    if (!read) return Mistake(read.error());
    address = *read;
  }
  if (args.record_s && rules->empty())
    return Mistake("nothing would be recorded: --record: give an --alarm, which starts recordings");

  Publishers opened;
  std::vector<AlarmListener*> listeners = args.listeners;
  Outlets outlets;
  for (const std::string& text : args.publish) {
    auto outlet = open_outlet(text, args);
    if (!outlet) return Mistake(outlet.error());
    listeners.push_back(outlet->get());
    outlets.push_back(std::move(*outlet));
  }
  if (args.record_s) {
    opened.recorder =
        std::make_unique<AlarmRecorder>(RecordOptions{*args.record_s, args.full_frame_every_s}, args.make_writer);
    listeners.push_back(opened.recorder.get());
  }
  AlarmPublisher* alarms = nullptr;
  if (!rules->empty()) {
    auto publisher =
        std::make_unique<AlarmPublisher>(*rules, args.folder.empty() ? "" : args.folder + "/alarms.csv", listeners);
    alarms = publisher.get();
    opened.all.push_back(std::move(publisher));
  }
  std::vector<const Publisher*> counted;
  for (auto& outlet : outlets) {
    counted.push_back(outlet.get());
    opened.all.push_back(std::move(outlet));
  }
  if (!address) return opened;
  MetricsFacts facts;
  if (alarms != nullptr) facts.alarms = [alarms] { return alarms->all(); };
  facts.lost_rows = [counted] {
    std::vector<std::pair<std::string, long>> lost;
    lost.reserve(counted.size());
    for (const Publisher* outlet : counted) lost.emplace_back(outlet->state().first, outlet->lost_rows());
    return lost;
  };
  auto metrics = MetricsPublisher::open(address->host, address->port, std::move(facts));
  if (!metrics) return mistake(metrics.error() + ": choose another port", "--listen " + args.listen);
  opened.all.insert(opened.all.begin(), std::move(*metrics));  // destroyed first: it reads the others
  return opened;
}

}  // namespace moiregauge::internal
