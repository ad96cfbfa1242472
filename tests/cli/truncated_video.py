"""Checks that a truncated video gives the frames before its end, and exit 5."""
from runs import insist, rows, run, simulate, start

program, work, _ = start()
simulate(program, work / "run", "small-1xyz", 12)
clip = work / "clip.mkv"
run(["ffmpeg", "-loglevel", "error", "-framerate", "10", "-i", work / "run/frames/%06d.png", "-c:v", "ffv1", "-pix_fmt", "gray",
     clip])
whole = clip.read_bytes()
(work / "cut.mkv").write_bytes(whole[:len(whole) * 6 // 10])
run([program, "measure", clip, "--site", work / "run/site.toml", "--method", "two-stage", "-o", work / "whole"])
done = run([program, "measure", work / "cut.mkv", "--site", work / "run/site.toml", "--method", "two-stage",
            "-o", work / "cut"], expected=5)  # in two-stage frames do not affect each other
kept, all_rows = rows(work / "cut"), rows(work / "whole")
insist(5 <= len(kept) < 12, f"{len(kept)} rows kept")
insist("cut.mkv" in done.stderr or "broke" in done.stderr or "damaged" in done.stderr, done.stderr)
good = [row[:4] for row in kept if row[-1] == "ok"]
insist(good == [row[:4] for row in all_rows[:len(good)]], "the frames before the break changed")
