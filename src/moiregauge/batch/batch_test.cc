// SPDX-License-Identifier: Apache-2.0
// Names, clips, states, catalogue and page of a batch, without measuring.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/batch/batch_csv.h"
#include "moiregauge/batch/batch_lock.h"
#include "moiregauge/batch/batch_run.h"
#include "moiregauge/batch/catalogue.h"
#include "moiregauge/batch/clip_job.h"
#include "moiregauge/batch/collect.h"
#include "moiregauge/batch/find_clips.h"
#include "moiregauge/batch/index_page.h"
#include "moiregauge/batch/run_name.h"
#include "moiregauge/batch/slurm_job.h"
#include "moiregauge/io/run_dir/unfinished_run.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

void put(const std::string& path, const std::string& text = "x") {
  fs::create_directories(fs::path(path).parent_path());
  put_text(path, text);
}

std::vector<std::string> inputs_of(const std::vector<Clip>& clips, const std::string& root) {
  std::vector<std::string> inputs;
  for (const Clip& clip : clips) inputs.push_back(fs::path(clip.input).lexically_relative(root).string());
  return inputs;
}

TEST(RunName, NoNameLeavesTheFolderOrHidesInIt) {
  for (const char* text : {"..", ".", "", "...", "a/b", "/", "-rf", "+x", "=1", "a\nb", "<script>", "'\"`$", "\x9b",
                           "a.b", "\xe2\x80\xae"}) {
    const std::string name = safe_name(text);
    EXPECT_FALSE(name.empty()) << text;
    EXPECT_EQ(name.find_first_of("./\n<>'\"`$=\x9b"), std::string::npos) << name;
    EXPECT_NE(name.front(), '-');
    EXPECT_NE(name.front(), '+');
  }
  EXPECT_EQ(safe_name("br\xc3\xbc"
                      "cke-1_(2)"),
            "br\xc3\xbc"
            "cke-1_(2)");
  // A long name is cut between characters.
  const std::string name = safe_name(std::string(79, 'a') + "\xc3\xbc");
  EXPECT_EQ(name, std::string(79, 'a'));
}

TEST(RunName, EqualNamesGetTheirFolders) {
  RunNames all;
  const auto names = all.names_of({"/d1/a.mp4", "/d2/a.mp4", "/d1/b.mp4", "/x/d1/A.mov", "/y/scan/frames"});
  ASSERT_EQ(names.size(), 5U);
  EXPECT_EQ(names[1], "a-d2");
  EXPECT_EQ(names[2], "b");
  EXPECT_EQ(names[4], "scan");
  // a-d1 and A-d1 differ on this file system, but not on every one: digits of the path distinguish them.
  EXPECT_EQ(names[0].substr(0, 5), "a-d1-");
  EXPECT_EQ(names[3].substr(0, 5), "A-d1-");
  EXPECT_EQ(names[0].size(), 13U);
  EXPECT_NE(names[0].substr(5), names[3].substr(5));
}

TEST(RunName, AClipKeepsItsNameWhenAnotherComes) {
  RunNames names;
  names.keep("/d1/a.mp4", "a");
  EXPECT_EQ(names.names_of({"/d1/a.mp4", "/d2/a.mp4"}), (std::vector<std::string>{"a", "a-d2"}));
}

TEST(FindClips, AFolderGivesVideosAndFoldersOfImages) {
  const TestFolder folder;
  for (const char* file : {"v.MP4", "notes.txt", "overview.jpg", "sub/w.mkv", "sub/site.toml", "scan/frames/1.png",
                           "scan/frames/2.png", "scan/site.toml", "one/stack.tif", ".hidden/x.mp4", "run/run.mgj",
                           "run/stabilised.mp4", "run.unfinished/x.mp4", "out/.batch/x", "out/y.mp4"})
    put(folder / file);
  fs::create_directory_symlink(folder.path(), folder / "loop");
  const auto clips = find_clips({folder.path() + "/"}, folder / "results");
  ASSERT_TRUE(clips);
  EXPECT_EQ(inputs_of(*clips, folder.path()),
            (std::vector<std::string>{"one/stack.tif", "scan/frames", "sub/w.mkv", "v.MP4"}));
  EXPECT_EQ((*clips)[1].site, folder / "scan/site.toml");
  EXPECT_EQ((*clips)[2].site, folder / "sub/site.toml");
  EXPECT_EQ((*clips)[3].site, "");
}

TEST(FindClips, AListIsRelativeToItself) {
  const TestFolder folder;
  put(folder / "lists/clips.txt", "# mine\n\n ../a.mp4 \r\nb c.mp4\n../a.mp4\n");
  put(folder / "a.mp4");
  const auto clips = find_clips({"@" + (folder / "lists/clips.txt")}, folder / "out");
  ASSERT_TRUE(clips);
  EXPECT_EQ(inputs_of(*clips, folder.path()), (std::vector<std::string>{"a.mp4", "lists/b c.mp4"}));
}

TEST(FindClips, NothingAndUnreadableListsAreErrors) {
  const TestFolder folder;
  EXPECT_FALSE(find_clips({folder.path()}, folder / "out"));
  EXPECT_FALSE(find_clips({"@" + (folder / "none.txt")}, folder / "out"));
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_FALSE(find_clips({"@" + (folder / "fifo")}, folder / "out")) << "and it does not wait";
  put(folder / "binary", std::string("a\0b", 3));
  EXPECT_FALSE(find_clips({"@" + (folder / "binary")}, folder / "out"));
}

// A batch with clips whose states and results are written by hand.
struct SmallBatch {
  TestFolder home;
  BatchFolder folder{home / "out"};
  std::vector<Clip> clips;

  explicit SmallBatch(const std::vector<std::string>& names) {
    EXPECT_TRUE(BatchLock::take(folder));
    for (const std::string& name : names) clips.push_back({"", home / name, ""});
    clips = register_clips(folder, clips).value();
  }
  ClipState finished(const Clip& clip, int exit, const std::string& message = "") const {
    ClipState state;
    state.is_finished = true;
    state.identity = identity_of(clip, {});
    state.identity.fingerprint = fingerprint_of(clip);
    state.exit_code = exit;
    state.message = message;
    state.wall_s = 1.5;
    EXPECT_TRUE(write_state(folder, clip.name, state));
    return state;
  }
  std::string query(const std::string& sql) const {
    std::string text;
    const auto done = query_catalogue(folder.catalogue(), sql, [&](std::string_view part) { text += part; });
    return done ? text : "error: " + done.error();
  }
};

TEST(Manifest, EveryPathSurvives) {
  const TestFolder folder;
  const Manifest written{{{"--fps=10", "--camera=/\xff.toml"}, true, 3, 1.5, 1000},
                         {{"a", "/x\n\"y'\xff/<b>", ""}, {"b", "/\xc3\xbc", "/s.toml"}}};
  ASSERT_TRUE(write_manifest(folder / "m", written));
  const auto read = read_manifest(folder / "m");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->options.measure, written.options.measure);
  EXPECT_EQ(read->options.threads, 3);
  ASSERT_EQ(read->clips.size(), 2U);
  EXPECT_EQ(read->clips[0].input, written.clips[0].input);
  EXPECT_EQ(read->clips[1].site, "/s.toml");
}

TEST(Manifest, DamagedLinesAndNamesOutsideAreRefused) {
  const TestFolder folder;
  ASSERT_TRUE(write_manifest(folder / "m", {{}, {{"a", "/a", ""}}}));
  const std::string good = text_of(folder / "m");
  for (const std::string bad : {"", "{", "[]", "{\"batch\":2}", "nonsense\n"}) {
    put_text(folder / "bad", bad);
    EXPECT_FALSE(read_manifest(folder / "bad")) << bad;
  }
  for (const std::string name : {"../x", "a/b", "", "."}) {
    put_text(folder / "bad", good + nlohmann::json{{"name", name}, {"input", "/a"}}.dump() + "\n");
    EXPECT_FALSE(read_manifest(folder / "bad")) << name;
  }
}

TEST(ClipState, AFinishedClipIsSkippedUntilSomethingChanges) {
  SmallBatch batch({"a.mp4"});
  const Clip& clip = batch.clips[0];
  put(clip.input, "film");
  EXPECT_EQ(need_of(clip, {}, read_state(batch.folder, clip.name), false), Need::kMeasure);
  batch.finished(clip, 0);
  const auto state = read_state(batch.folder, clip.name);
  ASSERT_TRUE(state);
  EXPECT_EQ(need_of(clip, {}, state, true), Need::kNothing);
  ClipOptions other;
  other.measure = {"--fps=10"};
  EXPECT_EQ(need_of(clip, other, state, false), Need::kRestart);
  // A copy with another time is the same clip.
  fs::last_write_time(clip.input, fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_EQ(need_of(clip, {}, state, false), Need::kNothing);
  put(clip.input, "another");
  EXPECT_EQ(need_of(clip, {}, state, false), Need::kRestart);
}

TEST(ClipState, AChangedSiteFileCounts) {
  SmallBatch batch({"a.mp4"});
  Clip clip = batch.clips[0];
  clip.site = batch.home / "site.toml";
  put(clip.input);
  put(clip.site, "one");
  const ClipState state = batch.finished(clip, 0);
  put(clip.site, "two");
  EXPECT_EQ(need_of(clip, {}, state, false), Need::kRestart);
  ClipOptions by_pitch;
  by_pitch.names_markers = true;
  const auto options = identity_of(clip, by_pitch).options;
  put(clip.site, "three");
  EXPECT_EQ(identity_of(clip, by_pitch).options, options) << "--pitch does not read it";
}

TEST(ClipState, AFailedClipIsRepeatedOnDemandOrWithMoreRoom) {
  SmallBatch batch({"a.mp4"});
  const Clip& clip = batch.clips[0];
  put(clip.input);
  ClipState state = batch.finished(clip, 3);
  EXPECT_EQ(need_of(clip, {}, state, false), Need::kNothing);
  EXPECT_EQ(need_of(clip, {}, state, true), Need::kMeasure);
  state.exit_code = 130;
  state.is_timed_out = true;
  state.time_limit_s = 10.0;
  ClipOptions limit;
  for (const auto& [seconds, need] :
       std::map<double, Need>{{10.0, Need::kNothing}, {20.0, Need::kMeasure}, {0.0, Need::kMeasure}}) {
    limit.time_limit_s = seconds;
    EXPECT_EQ(need_of(clip, limit, state, false), need) << seconds;
  }
  state.exit_code = 6;
  EXPECT_EQ(need_of(clip, {}, state, false), Need::kMeasure);
}

TEST(ClipState, ADamagedStateIsNone) {
  SmallBatch batch({"a.mp4"});
  for (const char* text : {"", "{", "[]", "{\"finished\":1}", "null"}) {
    put_text(batch.folder.state("a").string(), text);
    EXPECT_FALSE(read_state(batch.folder, "a")) << text;
  }
}

// A cluster asks all processes of a task to stop. The clip then continues elsewhere.
TEST(ClipJob, AProcessThatWasAskedToStopIsNoResult) {
  SmallBatch batch({"a.mp4"});
  put(batch.clips[0].input);
  const std::string program = batch.folder.path.string() + "/program";
  for (const auto& [signal, is_finished] :
       std::map<std::string, bool>{{"TERM", false}, {"HUP", false}, {"KILL", true}}) {
    put(program, "#!/bin/sh\nkill -" + signal + " $$\n");
    fs::permissions(program, fs::perms::owner_all);
    auto job = ClipJob::start(program, batch.folder, batch.clips[0], {}, Need::kMeasure);
    ASSERT_TRUE(job) << job.error();
    std::optional<ClipState> state;
    for (int k = 0; k < 500 && !state; ++k) {
      const auto polled = job->poll();
      ASSERT_TRUE(polled) << polled.error();
      state = *polled;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_TRUE(state);
    EXPECT_EQ(state->is_finished, is_finished) << signal;
    EXPECT_EQ(need_of(batch.clips[0], {}, *state, false) == Need::kNothing, is_finished) << signal;
  }
}

// The journal of a run, locked as by another `measure`. flock treats another open file like another process.
class OtherMeasurement {
 public:
  OtherMeasurement(const BatchFolder& folder, const std::string& name) {
    const std::string journal = folder.run(name).string() + ".unfinished/run.mgj";
    put(journal);
    file_ = ::open(journal.c_str(), O_RDWR | O_CLOEXEC);
    EXPECT_EQ(::flock(file_, LOCK_EX | LOCK_NB), 0);
  }
  OtherMeasurement(const OtherMeasurement&) = delete;
  OtherMeasurement& operator=(const OtherMeasurement&) = delete;
  ~OtherMeasurement() { end(); }
  void end() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }

 private:
  int file_ = -1;
};

BatchRequest request_with_program(const SmallBatch& batch, const std::string& script) {
  const std::string program = batch.folder.path.string() + "/program";
  put(program, "#!/bin/sh\n" + script + "\n");
  fs::permissions(program, fs::perms::owner_all);
  for (const Clip& clip : batch.clips) put(clip.input);
  return {program, batch.folder, {}, 1, false, [](const BatchProgress&) { return true; }, std::chrono::milliseconds(0)};
}

TEST(BatchRun, AClipThatAnotherProcessMeasuresIsNoFailure) {
  SmallBatch batch({"a.mp4", "b.mp4"});
  const BatchRequest request = request_with_program(batch, "exit 0");
  OtherMeasurement other(batch.folder, "a");
  const auto first = measure_clips(request, batch.clips);
  ASSERT_TRUE(first) << first.error();
  EXPECT_EQ(first->busy, std::vector<std::string>{"a"});
  EXPECT_EQ(first->progress.ended, 1U);
  EXPECT_EQ(first->progress.failed, 0U);
  EXPECT_FALSE(read_state(batch.folder, "a")) << "the other process may be that of another batch, which writes it";
  other.end();
  const auto second = measure_clips(request, batch.clips);
  ASSERT_TRUE(second) << second.error();
  EXPECT_TRUE(second->busy.empty());
  EXPECT_EQ(second->progress.ended, 1U) << "without --retry";
  EXPECT_EQ(second->progress.skipped, 1U);
}

TEST(BatchRun, AClipThatAnotherProcessFinishesMeanwhileComesLast) {
  SmallBatch batch({"a.mp4", "b.mp4"});
  const std::string order = batch.home / "order";
  BatchRequest request = request_with_program(batch, "echo $2 >> " + order);
  OtherMeasurement other(batch.folder, "a");
  request.patience = std::chrono::minutes(1);
  request.on_progress = [&](const BatchProgress& progress) {
    if (progress.ended == 1) other.end();
    return true;
  };
  const auto end = measure_clips(request, batch.clips);
  ASSERT_TRUE(end) << end.error();
  EXPECT_TRUE(end->busy.empty());
  EXPECT_EQ(text_of(order), batch.clips[1].input + "\n" + batch.clips[0].input + "\n");
}

TEST(BatchRun, AFinishedClipNeedsNoLock) {
  SmallBatch batch({"a.mp4"});
  const BatchRequest request = request_with_program(batch, "exit 1");
  batch.finished(batch.clips[0], 0);
  const OtherMeasurement other(batch.folder, "a");
  const auto end = measure_clips(request, batch.clips);
  ASSERT_TRUE(end) << end.error();
  EXPECT_TRUE(end->busy.empty());
  EXPECT_EQ(end->progress.skipped, 1U);
}

// The other process may begin after the batch has looked.
TEST(ClipJob, AnswerOfMeasureThatTheRunIsInUseIsNoResult) {
  SmallBatch batch({"a.mp4"});
  for (const auto& [message, is_finished] :
       std::map<std::string, bool>{{std::string(kRunInUse) + ": x", false}, {"unknown option: x", true}}) {
    const BatchRequest request = request_with_program(batch, "echo 'error: " + message + "' >&2; exit 2");
    ASSERT_TRUE(measure_clips(request, batch.clips));
    const auto state = read_state(batch.folder, "a");
    ASSERT_TRUE(state);
    EXPECT_EQ(state->exit_code, 2);
    EXPECT_EQ(state->is_finished, is_finished) << message;
  }
}

TEST(ClipJob, NoValueCanLookLikeAnOption) {
  ClipOptions options;
  options.measure = {"--rest=0:2"};
  const auto command = command_of("/bin/m", {"/o"}, {"a", "/-x.mp4", "/s.toml"}, options, Need::kRestart);
  EXPECT_EQ(command, (std::vector<std::string>{"/bin/m", "measure", "/-x.mp4", "--site=/s.toml", "--rest=0:2",
                                               "--threads=1", "--out=/o/a", "--restart", "--quiet"}));
}

TEST(BatchLock, TwoProcessesCannotOwnAFolder) {
  const TestFolder home;
  const BatchFolder folder{home / "out"};
  {
    const auto first = BatchLock::take(folder);
    ASSERT_TRUE(first);
    const auto second = BatchLock::take(folder);  // another open file: flock treats it like another process
    ASSERT_FALSE(second);
    EXPECT_TRUE(second.error().usage);
  }
  EXPECT_TRUE(BatchLock::take(folder));
  put(home / "taken/precious.txt");
  EXPECT_FALSE(BatchLock::take({home / "taken"}));
  EXPECT_FALSE(fs::exists(home / "taken/.batch"));
}

TEST(PlotText, LowestAndHighestOfEachColumn) {
  EXPECT_EQ(plot_text({0.0, 1.0, std::nan(""), 0.5}), "AAzz--^^");  // '^' is 'A' + 28.5, rounded up
  EXPECT_EQ(plot_text({}), "");
  EXPECT_EQ(plot_text({2.0, 2.0}), "^^^^");
  std::vector<double> ramp(64 * 100);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = double(i);
  const std::string plot = plot_text(ramp);
  ASSERT_EQ(plot.size(), 128U);
  EXPECT_TRUE(std::is_sorted(plot.begin(), plot.end()));
}

TEST(Catalogue, HostileTextIsData) {
  SmallBatch batch({"a'); DROP TABLE runs;--.mp4", "b.mp4"});
  batch.finished(batch.clips[0], 3, "it's \"so\"\n<b>");
  ASSERT_TRUE(collect_batch(batch.folder, [](std::size_t) { return true; }));
  EXPECT_EQ(
      batch.query("SELECT run, outcome, exit_code, message FROM runs ORDER BY outcome"),
      "run,outcome,exit_code,message\na_)__DROP_TABLE_runs_--,failed,3,\"it's \"\"so\"\"\\n<b>\"\nb,waiting,NaN,\n");
}

TEST(Catalogue, AQueryOnlyReads) {
  SmallBatch batch({"a.mp4"});
  ASSERT_TRUE(collect_batch(batch.folder, [](std::size_t) { return true; }));
  const std::string before = text_of(batch.folder.catalogue().string());
  for (const char* sql : {"DELETE FROM runs", "ATTACH 'x.db' AS x", "PRAGMA user_version = 2", "CREATE TABLE t (a)",
                          "SELECT 1; SELECT 2", "", "SELEC", "VACUUM INTO 'y.db'", "SELECT load_extension('x')"})
    EXPECT_EQ(batch.query(sql).substr(0, 7), "error: ") << sql;
  EXPECT_EQ(batch.query("SELECT count(*) AS n FROM runs;"), "n\n1\n");
  EXPECT_EQ(text_of(batch.folder.catalogue().string()), before);
}

TEST(Collect, AStoppedOneLeavesTheOldFiles) {
  SmallBatch batch({"a.mp4", "b.mp4"});
  ASSERT_TRUE(collect_batch(batch.folder, [](std::size_t) { return true; }));
  const std::string before = text_of(batch.folder.table().string());
  batch.finished(batch.clips[0], 3);
  ASSERT_TRUE(collect_batch(batch.folder, [](std::size_t done) { return done < 1; }));
  EXPECT_EQ(text_of(batch.folder.table().string()), before);
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(batch.folder.path)) files += entry.is_regular_file();
  EXPECT_EQ(files, 3U) << "nothing half written is left";
}

TEST(IndexPage, NoTextOfAClipEndsTheScript) {
  CollectedClip clip{{"a", "/x/</script><script>alert(1)</script>\n\xff", ""}, ClipState{}, RunSummary{}};
  clip.state->is_finished = true;
  clip.state->message = "<!--<script>";
  clip.run->targets.push_back({"<img onerror=x>", 3, 3, {}, {}, {}, {}, "<<<<"});
  const std::string entry = page_entry(clip);
  EXPECT_EQ(entry.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(entry)["targets"][0]["marker"], "<img onerror=x>");
  EXPECT_NE(page_parts().before.size(), 0U);
  EXPECT_TRUE(page_parts().after.starts_with("]</script>"));
}

TEST(BatchCsv, AClipWithoutResultsHasOneRow) {
  const CollectedClip clip{{"a", "/a,b", ""}, std::nullopt, std::nullopt};
  EXPECT_EQ(batch_csv_rows(clip), "\"/a,b\",a,NaN,,0,0,NaN,NaN,NaN,NaN,NaN,NaN,NaN,NaN,NaN,not measured so far\n");
}

TEST(SlurmJob, TenToThePowerOfFiveClipsAreFewerThanAThousandTasks) {
  for (const std::size_t clips : {1U, 10U, 9'990U, 9'991U, 100'000U, 1'000'000U}) {
    const std::size_t chunk = default_chunk(clips);
    EXPECT_LT((clips + chunk - 1) / chunk, 1000U) << clips;
    EXPECT_GE(chunk, 10U);
  }
}

TEST(SlurmJob, TasksShareAllClips) {
  std::vector<Clip> clips;
  for (int i = 0; i < 23; ++i) clips.push_back({std::to_string(i), "", ""});
  std::map<std::string, int> count;
  for (std::size_t task = 1; task <= 5; ++task)
    for (const Clip& clip : clips_of_task(clips, {task, 5})) ++count[clip.name];
  EXPECT_EQ(count.size(), 23U);
  for (const auto& [name, times] : count) EXPECT_EQ(times, 1) << name;
  EXPECT_EQ(task_number("3/40")->number, 3U);
  for (const char* text : {"", "3", "0/4", "5/4", "3/", "/4", "a/4", "3/4x", "-1/4"})
    EXPECT_FALSE(task_number(text)) << text;
}

}  // namespace
}  // namespace moiregauge::internal
