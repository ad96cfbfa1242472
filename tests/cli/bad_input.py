#!/usr/bin/python3
"""Checks the errors of a command for invalid arguments, files and folders, by a table.

    bad_input.py MOIREGAUGE COMMAND WORK

Each row of the table is (arguments, exit code, texts in the error line). Requires exactly one line that starts with
`error: `, nothing on stdout, and the exit code. The line has at least three parts, `error: what: where: what to do`,
and the last part is an instruction to the user.
"""
import pathlib
import re
import shutil
import subprocess
import sys

NO_SUCH = "nowhere.mp4"
TABLE = {
    "moiregauge": [
        ("frobnicate", 2, "moiregauge -h"),
        ("mesure clip.mp4", 2, "moiregauge measure"),
        ("--quiet", 2, "after the command"),
        ("--selftest", 2, "--selftest"),
        ("--pitch 10mm measure x", 2, "after the command"),
    ],
    "help": [
        ("help frobnicate", 2, "moiregauge help"),
        ("help mesure", 2, "moiregauge help measure"),
        ("help measure solve", 2, "solve"),
        ("help --mann measure", 2, "--man"),
    ],
    "measure": [
        ("measure", 2, "INPUT"),
        ("measure empty/clip.avi", 2, "--pitch 10mm, or a site file (docs/file-formats.md)"),
        ("measure clip.avi", 2, "--site site.toml"),
        ("measure scene/", 2, "--site scene/site.toml"),
        ("measure clip.avi --pich 10mm", 2, "did you mean --pitch"),
        ("measure clip.avi --pitch", 2, "the value is missing: measure --pitch"),
        ("measure clip.avi --pitch 10mm --fps 10 --fps 20", 2, "given twice: measure --fps: give it once"),
        ("measure clip.avi --pitch 10", 2, "10mm"),
        ("measure clip.avi --pitch -10mm", 2, "greater than 0"),
        ("measure clip.avi --pitch 10parsec", 2, "parsec"),
        ("measure clip.avi --pitch 10mm --site site.toml", 2, "give one of them"),
        ("measure clip.avi --site nowhere.toml", 2, "nowhere.toml"),
        ("measure clip.avi --site channel.toml", 2, "channel.toml:9:15: no target has the name 'top'"),
        ("measure clip.avi --pitch 10mm --camera nowhere.toml", 2, "nowhere.toml"),
        ("measure clip.avi --pitch 10mm --method best", 2, "two-stage"),
        ("measure clip.avi --pitch 10mm --axes up", 2, "print, image"),
        ("measure clip.avi --pitch 10mm --fps fast", 2, "--fps"),
        ("measure clip.avi --pitch 10mm --fps 0", 2, "--fps 25"),
        ("measure clip.avi --pitch 10mm --frames 5", 2, "0:100:2"),
        ("measure clip.avi --pitch 10mm --frames 9:3", 2, "0:100:2"),
        ("measure clip.avi --pitch 10mm --frames 1.5s:3", 2, "1.5s:3s"),
        ("measure clip.avi --pitch 10mm --frames 3s:1s", 2, "0:100:2"),
        ("measure clip.avi --pitch 10mm --slow-motion 0", 2, "240"),
        ("measure clip.avi --pitch 10mm --reference-frame -1", 2, "first is 0"),
        ("measure clip.avi --pitch 10mm --rest 3", 2, "0:20"),
        ("measure clip.avi --pitch 10mm --rest 1s:2parsec", 2, "0:20"),
        ("measure clip.avi --pitch 10mm --region 10,20,30", 2, "400,0,800,600"),
        ("measure clip.avi --pitch 10mm --exclude-region 10,20,0,30", 2, "400,0,800,600"),
        ("measure clip.avi --pitch 10mm --name T1", 2, "T1=midspan"),
        ("measure clip.avi --pitch 10mm --name T1=a,b", 2, "comma"),
        ("measure clip.avi --pitch 10mm --progress text", 2, "--progress"),
        ("measure clip.avi --pitch 10mm --readout 18", 2, "18ms"),
        ("measure clip.avi --pitch 10mm --template some", 2, "auto, on, off"),
        ("measure clip.avi --pitch 10mm --figures gif", 2, "pdf, svg, png"),
        ("measure clip.avi --pitch 10mm --exaggerate 5", 2, "--video"),
        ("measure clip.avi --pitch 10mm --video --exaggerate 0", 2, "from 1 to"),
        ("measure clip.avi --pitch 10mm --max-pixels 0", 2, "--max-pixels"),
        ("measure clip.avi --pitch 10mm --resume --restart", 2, "give one of them"),
        ("measure clip.avi --pitch 10mm --print-scale 100.12mm", 2, "1.0012"),
        ("measure clip.avi --pitch 10mm --print-scale 1.0012,", 2, "1.0012,0.9990"),
        ("measure clip.avi --pitch 10mm --print-scale 100.12", 2, "1.0012"),
        ("measure clip.avi --pitch 10mm --u-print-scale 0.0001", 2, "add what the rulers"),
        ("measure clip.avi --pitch 10mm --print-scale 1.001 --u-print-scale 0.2", 2, "0.0002"),
        ("measure clip.avi another.avi --pitch 10mm", 2, "another.avi"),
        (f"measure {NO_SUCH} --pitch 10mm", 3, NO_SUCH),
        ("measure text.mp4 --pitch 10mm", 3, "text.mp4"),
        ("measure empty --pitch 10mm", 3, "empty"),
        ("measure shot%04d.png --sequence --pitch 10mm", 3, "shot%04d.png"),
    ],
    "serve": [
        ("serve nowhere", 2, "give a folder with clips"),
        ("serve clip.avi", 2, "give a folder with clips"),
        ("serve . --port 70000", 2, "--port"),
        ("serve . --listen 0.0.0.0:8443", 2, "add --certificate FILE and --key FILE"),
        ("serve . --listen host:8443 --certificate clip.avi --key clip.avi", 2, "192.168.1.5:8443"),
        ("serve . --listen 127.0.0.1:0 --certificate clip.avi --key clip.avi", 2, "PEM"),
        ("serve . --listen 127.0.0.1:0 --port 3", 2, "write the port into --listen"),
        ("serve . --key clip.avi", 2, "add --listen ADDRESS:PORT"),
        ("serve . --token-file nowhere", 2, "a plain file with one line"),
        ("serve . --token-file clip.avi", 2, "16 to 128 letters and digits"),
        ("serve . --max-upload -1", 2, "--max-upload"),
        ("serve . --jobs 0", 2, "--jobs"),
        ("serve . --prt 1", 2, "did you mean --port"),
    ],
    "live": [
        ("live", 2, "SOURCE"),
        ("live clip.avi --pace 1", 2, "--pitch 10mm"),
        ("live clip.avi --pitch 10mm", 2, "--pace 1"),
        ("live clip.avi --pitch 10mm --pace 0", 2, "above 0"),
        ("live clip.avi --pitch 10mm --pace fast", 2, "max"),
        ("live clip.avi --pitch 10mm --pace 2000", 2, "1000"),
        ("live clip.avi --pitch 10mm --pace 1 --for 10", 2, "10min"),
        ("live clip.avi --pitch 10mm --pace 1 --for 0s", 2, "1h"),
        ("live clip.avi --pitch 10mm --pace 1 --segment 1week", 2, "s, min, h or d"),
        ("live clip.avi --pitch 10mm --pace 1 --keep 30d", 2, "--segment 1h"),
        ("live clip.avi --pitch 10mm --pace 1 --progress text", 2, "--progress"),
        ("live clip.avi --pitch 10mm --pace 1 --quota 5GB", 2, "--segment 1h"),
        ("live clip.avi --pitch 10mm --pace 1 --segment 1h --quota 5", 2, "20GB"),
        ("live clip.avi --pitch 10mm --pace 1 --segment 1h --restart", 2, "another folder"),
        ("live clip.avi --pitch 10mm --pace 1 --resume --restart", 2, "give one of them"),
        ("live clip.avi --pitch 10mm --pase 1", 2, "did you mean --pace"),
        ("live clip.avi --pitch 10mm --pace 1 --gain 3", 2, "remove --gain"),
        ("live - --pitch 10mm --exposure 5", 2, "5ms"),
        ("live - --pitch 10mm --exposure 5ms", 2, "omit --exposure"),
        ("live - --pitch 10mm --patience 1week", 2, "s, min, h or d"),
        ("live camera:none --pitch 10mm --sensor-region 1,2,3", 2, "0,512,2048,1024"),
        ("live camera:none --pitch 10mm --packet-size 10", 2, "--packet-size"),
        ("live camera:none --pitch 10mm --mosaic red", 2, "green or luma"),
        ("live camera:none --pitch 10mm", 3, "--list"),
        ("live http://127.0.0.1:9/x --pitch 10mm --fps 25", 2, "omit --fps"),
        ("live clip.avi --pitch 10mm --pace 1 --alarm T1.dy>2", 2, "column 8"),
        ("live clip.avi --pitch 10mm --pace 1 --publish ftp://host/x", 2, "give mqtt://"),
        ("live clip.avi --pitch 10mm --pace 1 --publish mqtt://host", 2, "mqtt://HOST/bridge"),
        ("live clip.avi --pitch 10mm --pace 1 --publish mqtt://u:p@host/x", 2, "MOIREGAUGE_PASSWORD"),
        ("live clip.avi --pitch 10mm --pace 1 --listen 0.0.0.0:9464", 2, "give 127.0.0.1"),
        ("live clip.avi --pitch 10mm --pace 1 --listen port", 2, "127.0.0.1:9464"),
        ("live clip.avi --pitch 10mm --pace 1 --record 10s", 2, "--alarm"),
        ("live clip.avi --pitch 10mm --pace 1 --alarm T1.dy>2mm --record 2h", 2, "at most 1 h"),
        ("live clip.avi --pitch 10mm --pace 1 --alarm T1.dy>2mm --record-full 5s", 2, "add --record"),
        (f"live {NO_SUCH} --pitch 10mm --pace 1", 3, NO_SUCH),
        ("live text.mp4 --pitch 10mm --pace max", 3, "text.mp4"),
        ("live empty --pitch 10mm --pace 1 --fps 5", 3, "empty"),
    ],
    "plan": [
        ("plan", 2, "--distance"),
        ("plan --distance 5", 2, "unit"),
        ("plan --distance 5m", 2, "--camera NAME"),
        ("plan --distance 5m --camera imx999", 2, "imx250, imx255"),
        ("plan --distance 5m --camera imx255", 2, "--focal 12mm"),
        ("plan --distance 5m --camera imx255 --focal 12", 2, "unit"),
        ("plan --distance 5m --camera imx255 --focal 12mm --fov 60", 2, "give one of them"),
        ("plan --distance 5m --resolution 4096 --fov 60", 2, "4096x2160"),
        ("plan --distance 5m --resolution 4096x2160 --focal 12mm", 2, "--pixel"),
        ("plan --distance 5m --camera text.mp4", 2, "text.mp4"),
        ("plan --distance 5m --camera imx255 --focal 12mm --fps 0", 2, "--fps"),
        ("plan --distance 5m --camera imx255 --focal 12mm --exposure 1s", 2, "--exposure"),
        ("plan --distance 5m --camera imx255 --focal 12mm --vibration 2mm", 2, "0.5mm@5Hz"),
        ("plan --distance 5m --camera imx255 --focal 12mm --vibration 1e300mm@1e300Hz", 2, "0.5mm@5Hz"),
        ("plan --distance 5m --camera imx255 --focal 12mm --camera-vibration 2mm@3Hz", 2, "0.01deg@10Hz"),
        ("plan --distance 500m --camera imx255 --focal 12mm --span 9x3m --pitch 10mm", 2, "px in the image"),
        ("plan --distance 500m --camera imx255 --focal 12mm --span 9x3m", 2, "wider --span"),
        ("plan --distance 5m --camera imx255 --focal 12mm --site nowhere.toml", 2, "nowhere.toml"),
    ],
    "sheet": [
        ("sheet --paper A9", 2, "A0, A1"),
        ("sheet --paper 300x400", 2, "300x400mm"),
        ("sheet --paper 20x30mm", 2, "90"),
        ("sheet --pattern stripes", 2, "grid, squares"),
        ("sheet --pitch 10", 2, "10mm"),
        ("sheet --pitch 1e-6mm", 2, "0.01"),
        ("sheet --span 1e9x1e9m", 2, "1e+06 mm"),
        ("sheet --span 760", 2, "760x56mm"),
        ("sheet --references 5", 2, "give 4, or 6"),
        ("sheet --targets -1", 2, "--targets"),
        ("sheet --targets 9", 2, "fewer targets"),
        ("sheet --pitch 90mm", 2, "smaller --pitch"),
        ("sheet --pitch 400mm --span 16x12m", 2, "64 parts"),
        ("sheet --pitch 60mm --span 3x2m --pattern cosine", 2, "not printed in parts"),
        ("sheet --references 6", 2, "fit with --pitch"),
        ("sheet --separate", 2, "--span"),
        ("sheet --orientation up", 2, "portrait"),
        ("sheet --ink 0", 2, "--ink"),
        ("sheet --gamma 9 --pattern cosine", 2, "--gamma"),
        ("sheet --site nowhere.toml", 2, "nowhere.toml"),
        ("sheet --site nowhere.toml --pitch 10mm", 2, "remove those options"),
        ("sheet -o empty/../text.mp4", 2, "text.mp4"),
    ],
    "solve": [
        ("solve", 2, "DIR"),
        ("solve nowhere", 3, "nowhere"),
        ("solve text.mp4", 3, "text.mp4"),
        ("solve empty", 3, "run.mgj"),
        ("solve empty --sit x", 2, "did you mean --site"),
        ("solve empty --figures pdf,", 2, "pdf, svg, png"),
        ("solve empty again", 2, "again"),
    ],
    "derive": [
        ("derive", 2, "DIR"),
        ("derive nowhere --channel c=mid.dy", 3, "nowhere"),
        ("derive text.mp4 --channel c=mid.dy", 3, "text.mp4"),
        ("derive empty --channel c=mid.dy", 3, "run.mgj"),
        ("derive empty --chanel c=mid.dy", 2, "did you mean --channel"),
        ("derive empty again", 2, "again"),
        ("derive empty", 3, "run.mgj"),
        ("derive empty --channel c=mid.dy --velocty 5Hz", 2, "did you mean --velocity"),
    ],
    "compare": [
        ("compare", 2, "DIR"),
        ("compare empty", 2, "REFERENCE"),
        ("compare empty lvdt.csv", 2, "--channel"),
        ("compare empty nowhere.csv --channel mid.dy", 3, "nowhere.csv (no such file)"),
        ("compare empty empty --channel mid.dy", 3, "CSV file"),
        ("compare empty text.mp4 --channel mid.dy", 3, "--column"),
        ("compare empty lvdt.csv --channel mid.dy --column 3", 2, "column \"3\""),
        ("compare empty lvdt.csv --channel mid.dy --column load", 2, "one of t, mm"),
        ("compare empty oops.csv --channel mid.dy", 3, "oops.csv:3"),
        ("compare empty back.csv --channel mid.dy", 3, "back.csv:3"),
        ("compare empty lvdt.csv --channel mid.dy --rate 0", 2, "--rate 100"),
        ("compare empty lvdt.csv --channel mid.dy --rate 5 --time-column 1", 2, "give one of them"),
        ("compare empty lvdt.csv --channel mid.dy --sign 2", 2, "--sign -1"),
        ("compare empty lvdt.csv --channel mid.dy --scale 0", 2, "--scale"),
        ("compare empty lvdt.csv --channel mid.dy", 3, "run.mgj"),
        ("compare nowhere lvdt.csv --channel mid.dy", 3, "nowhere"),
        ("compare empty lvdt.csv again --channel mid.dy", 2, "again"),
    ],
    "export": [
        ("export", 2, "DIR"),
        ("export nowhere", 3, "nowhere"),
        ("export text.mp4", 3, "is not a folder"),
        ("export empty", 3, "run.json"),
        ("export empty --format parquet", 2, "wide, csv, long, xlsx, mat, hdf5, uff58"),
        ("export empty --gaps fill", 2, "refuse, split"),
        ("export empty --time 5", 2, "2:8.5"),
        ("export empty --time 5:2", 2, "2:8.5"),
        ("export empty --axis z", 2, "x, y"),
        ("export empty --format uff58 --axis y", 2, "csv, xlsx or mat"),
        ("export empty --format mat --decimal-comma", 2, "--format csv"),
        ("export empty --separator |", 2, "tab"),
        ("export empty --decimal-comma --separator ,", 2, "separator and decimal mark"),
        ("export empty --frames 5", 2, "1.5s:3s"),
        ("export empty --frames 0:5 --time 0:1", 2, "give one of them"),
        ("export empty -o text.mp4", 2, "--replace"),
    ],
    "inspect": [
        ("inspect", 2, "INPUT"),
        (f"inspect {NO_SUCH}", 3, NO_SUCH),
        ("inspect text.mp4", 3, "text.mp4"),
        ("inspect empty", 3, "empty"),
        ("inspect text.mp4 --frame -1", 2, "first is 0"),
        ("inspect text.mp4 --frame one", 2, "--frame"),
        ("inspect text.mp4 --pitch 10", 2, "10mm"),
        ("inspect text.mp4 --write-site found.toml", 2, "--pitch 10mm"),
        ("inspect text.mp4 --pitch 10mm --write-site text.mp4", 2, "exists"),
        ("inspect text.mp4 --pitch 10mm --region 1", 2, "400,0,800,600"),
        ("inspect text.mp4 --jason", 2, "did you mean --json"),
    ],
    "calibrate": [
        ("calibrate", 2, "PHOTOS"),
        ("calibrate nowhere.png", 2, "--pitch"),
        ("calibrate nowhere.png --pitch 10", 2, "10mm"),
        ("calibrate nowhere.png --pitch 10mm", 3, "nowhere.png"),
        ("calibrate text.mp4 --pitch 10mm", 3, "text.mp4"),
        ("calibrate empty --pitch 10mm", 3, "empty"),
        ("calibrate nowhere.png --pitch 10mm --k4", 2, "did you mean --k3"),
    ],
    "simulate": [
        ("simulate", 2, "--list"),
        ("simulate small-2xyz", 2, "small-2xyz"),
        ("simulate site.toml", 2, "site.toml"),
        ("simulate small-1x --set lens.k1", 2, "KEY=VALUE"),
        ("simulate small-1x --set lens.k9=1", 2, "lens.k9"),
        ("simulate small-1x --frames 0", 2, "frames"),
        ("simulate small-1x --frames many", 2, "--frames"),
        ("simulate small-1x --codec h265", 2, "x264"),
        ("simulate small-1x --quality 3", 2, "--codec"),
        ("simulate small-1x --frams 3", 2, "did you mean --frames"),
        ("simulate small-1x --threads -1", 2, "--threads"),
        ("simulate small-1x --frames 1 -o taken", 2, "taken"),
        ("simulate small-1x --frames 1 -o text.mp4/out", 6, "text.mp4/out"),
    ],
    "reproduce": [
        ("reproduce again", 2, "again"),
        ("reproduce --quik", 2, "did you mean --quick"),
        ("reproduce --threads many", 2, "--threads"),
        ("reproduce -o taken", 2, "taken"),
        ("reproduce --quick -o text.mp4/out", 6, "text.mp4/out"),
    ],
    "batch": [
        ("batch", 2, "-o DIR"),
        ("batch clip.avi", 2, "-o DIR"),
        ("batch -o out", 2, "@clips.txt"),
        ("batch empty -o out", 3, "folders that contain videos"),
        ("batch nowhere/ -o out --retry --pitch 10", 2, "10mm"),
        ("batch @nowhere.txt -o out", 3, "nowhere.txt"),
        ("batch @taken -o out", 3, "one path per line"),
        ("batch clip.avi -o taken", 2, "choose a new folder"),
        ("batch clip.avi -o text.mp4", 2, "choose a new folder"),
        ("batch clip.avi -o text.mp4/out", 6, "choose another with -o"),
        ("batch clip.avi -o out --pitch 10mm --site site.toml", 2, "give one of them"),
        ("batch clip.avi -o out --fps 0", 2, "--fps 25"),
        ("batch clip.avi -o out --figures bmp", 2, "pdf"),
        ("batch clip.avi -o out --jobs 0", 2, "--jobs"),
        ("batch clip.avi -o out --jobs many", 2, "--jobs"),
        ("batch clip.avi -o out --time-limit 10", 2, "10min"),
        ("batch clip.avi -o out --memory-limit 2", 2, "2GB"),
        ("batch clip.avi -o out --chunk 5", 2, "add --slurm"),
        ("batch clip.avi -o out --sbatch=--nice", 2, "add --slurm"),
        ("batch clip.avi -o out --slurm --collect", 2, "give one of them"),
        ("batch clip.avi -o out --collect", 2, "omit the INPUTS"),
        ("batch --collect -o out", 2, "the folder of a batch"),
        ("batch --query SELECT -o out", 2, "--collect"),
        ("batch --query SELECT --collect -o out", 2, "give one of them"),
        ("batch --task 1/2", 2, "--manifest"),
        ("batch --manifest clip.avi", 2, "--task"),
        ("batch --task 3/2 --manifest clip.avi", 2, "3/40"),
        ("batch --task 1/2 --manifest clip.avi", 2, "clip.avi"),
        ("batch --task 1/2 --manifest nowhere -o out", 2, "omit INPUTS"),
        ("batch clip.avi --json -o out", 2, "--json"),
        ("batch clip.avi --restart -o out", 2, "--restart"),
    ],
    "completion": [
        ("completion", 2, "SHELL"),
        ("completion fish", 2, "bash, zsh"),
    ],
}


def prepare(work):
    shutil.rmtree(work, ignore_errors=True)
    (work / "empty").mkdir(parents=True)
    (work / "taken").mkdir()
    (work / "taken" / "notes.txt").write_text("precious\n")
    (work / "text.mp4").write_text("not a video\n")
    (work / "lvdt.csv").write_text("t,mm\n0,1\n1,2\n")
    (work / "oops.csv").write_text("t,mm\n0,1\n1,oops\n")
    (work / "back.csv").write_text("t,mm\n0,1\n0,2\n")
    (work / "clip.avi").write_text("not a video either\n")
    (work / "site.toml").write_text("[grating]\n")
    (work / "channel.toml").write_text(
        '[grating]\npitch_mm = 10\n[[target]]\nname = "mid"\ngrating_mm = [0, 0]\ngrating_size_mm = [40, 40]\n'
        '[[channel]]\nname = "d"\nexpression = "top.dy"\n')
    (work / "scene").mkdir()
    (work / "scene" / "site.toml").write_text("[grating]\n")


def mistakes_of(done, exit_code, named):
    if done.returncode != exit_code:
        yield f"exit code {done.returncode}, expected {exit_code}"
    if done.stdout:
        yield "something on stdout"
    lines = done.stderr.splitlines()
    errors = [line for line in lines if line.startswith("error: ")]
    if len(errors) != 1 or lines[0] != errors[0]:
        yield f"{len(errors)} lines start with 'error: ', expected the first and no other"
        return
    if len(errors[0].split(": ")) < 3:
        yield "not of the form error: what: where: what to do"
    if not re.search(re.escape(named), done.stderr):
        yield f"does not name {named}"


def main():
    program, command, work = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    prepare(work)
    files = sorted(work.rglob("*"))
    failed = 0
    for words, exit_code, named in TABLE[command]:
        done = subprocess.run([program, *words.split()], cwd=work, capture_output=True, text=True, check=False, timeout=60)
        wrong = list(mistakes_of(done, exit_code, named))
        if sorted(work.rglob("*")) != files:
            wrong.append("it left something behind")
            prepare(work)
        if wrong:
            failed += 1
            print("moiregauge", words, "", done.stderr.strip(), *wrong, "", sep="\n")
    print(f"{len(TABLE[command]) - failed} of {len(TABLE[command])} rows as they should be")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
