// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/block_text.h"

#include <gtest/gtest.h>

#include "moiregauge/live/publish/outlet_url.h"

namespace moiregauge::internal {
namespace {

LiveRun one_target() {
  LiveRun run;
  run.source = "camera:A=1, b";
  run.markers = {"T \"1\""};
  run.targets = {0};
  return run;
}

RowBlock two_rows() {
  RowBlock block;
  block.utc_ns = 2'000'000'000;
  block.rows.push_back({7, 0.14, 1'000'000'000, 0, 0.1, -0.25, 0.002, 0.001, Status::kOk});
  OutletRow lost;
  lost.frame = 8;
  lost.time_s = 0.16;
  lost.utc_ns = 2'000'000'000;
  block.rows.push_back(lost);
  return block;
}

TEST(BlockText, JsonHasNullWhereNothingWasMeasured) {
  EXPECT_EQ(
      rows_json(one_target(), two_rows()),
      R"({"source":"camera:A=1, b","utc_ns":2000000000,"frame":[7,8],"time_s":[0.14,0.16],"marker":["T \"1\"","T \"1\""],)"
      R"("dx_mm":[0.1,null],"dy_mm":[-0.25,null],"u_dx_mm":[0.002,null],"u_dy_mm":[0.001,null],"status":["ok","lost"]})");
}

TEST(BlockText, LineProtocolOmitsWhatWasNotMeasured) {
  RowBlock block = two_rows();
  AlarmEvent event;
  event.rule = "T1.dy > 2 mm";
  event.marker = "T1";
  event.is_raised = true;
  event.utc_ns = 3;
  event.value_mm = 2.5;
  block.alarms.push_back(event);
  EXPECT_EQ(
      influx_lines(one_target(), block),
      "moiregauge,marker=T\\ \"1\",source=camera:A\\=1\\,\\ b "
      "dx_mm=0.1,dy_mm=-0.25,u_dx_mm=0.002,u_dy_mm=0.001,time_s=0.14,frame=7i,status=\"ok\" "
      "1000000000\n"
      "moiregauge,marker=T\\ \"1\",source=camera:A\\=1\\,\\ b time_s=0.16,frame=8i,status=\"lost\" 2000000000\n"
      "moiregauge_alarm,marker=T1,rule=T1.dy\\ >\\ 2\\ mm,source=camera:A\\=1\\,\\ b value_mm=2.5,raised=true 3\n");
}

TEST(BlockText, PrometheusPageHasOneTypePerName) {
  MetricsPage page;
  page.run = one_target();
  page.rows = two_rows().rows;
  page.alarms = {{"T1.dy > 2 mm", true}};
  page.health.lost.incomplete = 3;
  const std::string text = metrics_text(page);
  EXPECT_NE(text.find("moiregauge_displacement_mm{marker=\"T \\\"1\\\"\",axis=\"y\"} -0.25\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("moiregauge_frames_lost_total{cause=\"incomplete\"} 3\n"), std::string::npos);
  EXPECT_NE(text.find("moiregauge_alarm{rule=\"T1.dy > 2 mm\"} 1\n"), std::string::npos);
  EXPECT_NE(text.find("moiregauge_frame_rate_hz NaN\n"), std::string::npos);
  std::size_t names = 0, types = 0;
  for (std::size_t at = 0; (at = text.find("# HELP ", at)) != std::string::npos; ++at) ++names;
  for (std::size_t at = 0; (at = text.find("# TYPE ", at)) != std::string::npos; ++at) ++types;
  EXPECT_EQ(names, types);
}

TEST(OutletUrl, PartsAreSeparated) {
  const auto url = parse_outlet_url("mqtts://gauge@[::1]:8883/bridge/span2?x=1");
  ASSERT_TRUE(url);
  EXPECT_EQ(url->scheme, "mqtts");
  EXPECT_EQ(url->user, "gauge");
  EXPECT_EQ(url->host, "::1");
  EXPECT_EQ(url->port, 8883);
  EXPECT_EQ(url->path, "/bridge/span2?x=1");
  EXPECT_EQ(parse_outlet_url("mqtt://broker")->path, "");
}

TEST(OutletUrl, MistakesAreRefused) {
  for (const char* text : {"", "broker", "://broker", "mqtt://", "mqtt://:1883/x", "mqtt://h:0/x", "mqtt://h:65536/x",
                           "mqtt://h:1x/x", "mqtt://h/a b", "mqtt://user:secret@h/x", "mqtt://h/\n"})
    EXPECT_FALSE(parse_outlet_url(text)) << text;
}

}  // namespace
}  // namespace moiregauge::internal
