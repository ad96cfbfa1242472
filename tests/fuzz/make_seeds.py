#!/usr/bin/python3
"""Makes the seeds of the fuzz targets: small real inputs, written by the program itself and by ffmpeg.

    make_seeds.py MOIREGAUGE      # path of the program; writes corpus/<target>/seed-* and no other file
"""
import pathlib
import sqlite3
import subprocess
import sys
import tempfile

import numpy

HERE = pathlib.Path(__file__).resolve().parent
REAL = HERE.parent / "real" / "data"
RIG = "color=gray:size=24x16,noise=alls=40:allf=t"  # a small video


def run(*words, cwd):
    return subprocess.run([str(word) for word in words], cwd=cwd, check=True, capture_output=True).stdout


def put(target, name, content):
    folder = HERE / "corpus" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"seed-{name}").write_bytes(content.encode() if isinstance(content, str) else content)


def film(work, name, *options, frames=2):
    run("ffmpeg", "-loglevel", "error", "-y", "-f", "lavfi", "-i", RIG, "-frames:v", frames, "-bitexact", *options, name,
        cwd=work)
    return (work / name).read_bytes()


def grey_of(path, work, scale=1.0, crop=None):
    """Returns the grey levels of an image, first cropped (x, y, width, height), then scaled."""
    steps = ["crop={2}:{3}:{0}:{1}".format(*crop)] if crop else []
    steps += [f"scale=round(iw*{scale}):-1:flags=area", "format=gray"]
    run("ffmpeg", "-loglevel", "error", "-i", path, "-frames:v", 1, "-vf", ",".join(steps), "-f", "rawvideo",
        "picture.grey", "-y", cwd=work)
    size = run("ffprobe", "-v", "error", "-show_entries", "stream=width,height", "-of", "csv=p=0", path, cwd=work)
    width = crop[2] if crop else int(size.split(b",")[0])
    width = int(numpy.floor(width * scale + 0.5))
    grey = numpy.fromfile(work / "picture.grey", numpy.uint8)
    return grey.reshape(-1, width)


def markers(name, grey, words=0):
    put("markers", name, bytes([grey.shape[1] - 16, words]) + grey.tobytes())


def texts(moiregauge, work):
    run(moiregauge, "simulate", "small-1xyz", "--frames", 2, "--markers-only", "-o", "rig", cwd=work)
    run(moiregauge, "measure", "rig/frames", "--site", "rig/site.toml", "--fps", 10, "--method", "two-stage", "--quiet",
        "-o", "run", cwd=work)
    put("site_file", "simulated", (work / "rig/site.toml").read_bytes())
    put("site_file", "real", (REAL / "board-checker/site.toml").read_bytes())
    put("site_file", "every-key", '[grating]\npitch_mm = 10\npattern = "squares"\nangle_deg = 1.5\n[[reference]]\n'
        'name = "NW"\ncircle_mm = [-395.0, 3.4e1]\ncircle_diameter_mm = 20.0\n[[target]]\ngrating_mm = [0, 0]\n'
        'grating_size_mm = [60.0, 60.0]\npitch_mm = 5.0\npattern = "lines-x"\nz_mm = -30.0\n[known_to]\nposition_mm = 1.0\n'
        'rotation_deg = 0.3\nheight_mm = 3.0\nprint_scale = 0.0005\n')
    put("site_file", "channels", '[[target]]\nname = "mid"\ngrating_mm = [0, 0]\ngrating_size_mm = [60, 60]\npitch_mm = 5\n'
        '[[channel]]\nname = "rise"\nexpression = "mid.dy"\n[[channel]]\nname = "c"\nunit = "um"\n'
        "expression = '2 * rise - \"mid\".dx'\n")
    put("camera_file", "simulated", (work / "rig/truth-camera.toml").read_bytes())
    put("camera_file", "solved", '[camera]\nmodel = "brown"\nwidth = 1024\nheight = 512\nfx = 3478.26\nfy = 3478.26\n'
        'cx = 511.5\ncy = 255.5\nk1 = -0.37\nk2 = 0.0\np1 = 0.0\np2 = 0.0\nk3 = 0.0\n[camera.u]\nfx = 1.5\ncx = 2.0\ncy = 2.0\n'
        'k1 = 0.01\nk2 = 0.1\np1 = 0.001\np2 = 0.001\nk3 = 0.5\n')
    put("camera_file", "opencv.yml", '%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n'
        '   rows: 3\n   cols: 3\n   dt: d\n   data: [ 5.3e+02, 0., 3.2e+02, 0.,\n       5.3e+02, 2.4e+02, 0., 0., 1. ]\n'
        'distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n'
        '   data: [ -2.8e-01, 3.9e-02, 1.2e-03, -1.0e-04, 1.5e-01 ]\n')
    put("camera_file", "ros.yaml", 'image_width: 640\nimage_height: 480\ncamera_name: c\ncamera_matrix:\n  rows: 3\n  cols: 3\n'
        '  data: [530.1, 0, 320.5, 0, 530.2, 240.5, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n'
        '  rows: 1\n  cols: 5\n  data:\n  - -0.28\n  - 0.04\n  - 0.001\n  - 0\n  - 0\n')
    put("channel", "sag", "sag = mid.dy - (left.dy + 'span 2'.dy) / 2")
    put("channel", "strain", "e = strain(mid, left) * 1e-3 + 2")
    put("channel", "unit", "slope [rad] = -mean(mid.dx, tilt) / 120.5")
    put("channel", "product", "c = mid.dy * left.dy")
    put("channel", "open", "c = ((((-+-mid.rotation")
    put("y4m_header", "grey", "YUV4MPEG2 W640 H480 F30000:1001 Ip A1:1 Cmono12 XCOLORRANGE=FULL")
    put("y4m_header", "yuv", "YUV4MPEG2 W5 H3 F25:1 It C420p10")
    put("alarm_rule", "full", "|T1.dy| > 2 mm for 0.5 s until 1.5mm")
    put("alarm_rule", "quoted", "\"pier 2\".dx < -25um for 2 min")
    put("alarm_rule", "address", "mqtts://gauge@[::1]:8883/bridge/span2")
    head = "POST /api/x?path=a%20b&frame=3 HTTP/1.1\r\nHost: 127.0.0.1:8765\r\nContent-Type: application/json\r\nContent-Length: 9\r\n\r\n"
    put("serve_request", "inspect", head + '{"path":"sub/a.mp4","pitch":"10mm","frame":3,"region":[1,2,30,40],"exclude":[[0,0,5,5]],'
        '"references":["R1","R2"],"targets":[],"ignore":["R5"],"names":{"T1":"mid span"},"axes":"image","site":null}')
    put("serve_request", "job", head + '{"action":"measure","arguments":["sub/a b.mp4","--pitch","10mm","--resume","--region","1,2,3,4"]}')
    put("serve_request", "derive", head + '{"action":"derive","arguments":["run","--channel","d = T1.dy - \'span 2\'.dy","--zero","0:5","-o","d.csv"]}')
    put("serve_request", "live", head + '{"source":"camera:Fake_1","arguments":["--pitch","10mm","--alarm","|T1.dy| > 1 mm","--pace","max"]}')
    put("serve_request", "smuggled", head.replace("Content-Type", "Transfer-Encoding") + '{"a":[[[[{"b":"\\ud83d\\ude00","b":1e99}]]]]}')
    put("serve_request", "progress", '{"type":"samples","marker":{"T1":[[0,0,null,0.1,0.01,0.02,0]]}}')
    options = '{"batch":1,"measure":[{"value":"--fps=10"},{"value_hex":"2d2d63616d6572613d2fff"}],"names_markers":true,"threads":2,'
    options += '"time_limit_s":1.5,"memory_limit_bytes":4000000000}\n'
    put("batch_list", "manifest", options + '{"name":"a","input":"/clips/a.mkv","site":"/clips/site.toml"}\n'
        '{"name":"b-two","input_hex":"2f636c6970732fff2e6d6b76"}\n')
    put("batch_list", "by-hand", "# spans\n  a.mkv\r\nb c.mkv\n\n..\n.\na.mkv\n")
    put("batch_query", "peaks", "SELECT run, marker, f1_hz FROM targets WHERE ok = frames ORDER BY f1_hz")
    put("batch_query", "join", "SELECT r.run, count(*) AS n FROM runs r JOIN peaks USING (run) GROUP BY 1 HAVING n > 0 LIMIT 3;")
    put("batch_query", "endless", "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT count(*) FROM n")
    put("batch_query", "change", "ATTACH 'x.db' AS x")
    with sqlite3.connect(work / "catalogue.sqlite") as database:
        database.executescript("CREATE TABLE runs (run TEXT PRIMARY KEY, clip TEXT) WITHOUT ROWID; INSERT INTO runs VALUES ('a', 'b');"
                               "CREATE TABLE warnings (run TEXT, text TEXT); INSERT INTO warnings VALUES ('a', 'c');")
    put("batch_query", "catalogue", (work / "catalogue.sqlite").read_bytes())
    put("scenario_file", "every-kind", 'base = "small-1xyz"\nframes = 50\n[lens]\nk1 = -0.1\n[rotation.z]\n'
        'knots = [[0, 0], [5, 0.8]]\n[[marker]]\nname = "beam"\nrole = "target"\ngrating_mm = [0, 0]\n'
        'grating_size_mm = [40, 40]\npitch_mm = 10\n[marker.dy]\nknots = [[0, 0], [2, 1]]\n[marker.cover]\nframes = [[2, 4]]\n'
        'share = 0.5\n[sensor]\nbits = 12\nreadout_s = 0.02\n[known_to]\nposition_mm = 1.0\n[truth]\ndraw_known_to = true\n')
    put("scenario_file", "set-track", "marker.mid.dy.knots=[[0,0],[2,1]]")
    put("scenario_file", "set-lens", "lens.k1=-0.0225")
    put("scenario_file", "length", "10000 \u00b5m")
    put("run_json", "measured", (work / "run/run.json").read_bytes()[:1500])
    put("displacement_csv", "measured", (work / "run/displacement.csv").read_bytes()[:1500])
    put("displacement_csv", "quoted", 'frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status,more\n0,0.0,"a ""b"", c",0,0,0,0,ok,1\n2,NaN,b,NaN,1,NaN,1,lost,\n')
    put("reference_csv", "semicolons", "\0Logger\nt;mm\n0,0;1,5\n0,1;-2e-3\n")
    put("reference_csv", "quoted", '\1# logger\n"t","mm"\n"0","1,5"\n"0,1",NaN\n')
    put("reference_csv", "dates", "\0t;mm\n31.12.2026 23:59:59,50;1\n1.1.2027 0:00:00,25;2\n")
    put("reference_csv", "milliseconds", "\0Time [ms],mm\n10,1\n20,2\n")
    put("reference_csv", "tabs", "\2n\tmm\n1\t+4\n2\t\n3\t.5\n")
    put("run_json", "whole", '{"schema":1,"input":{"path":"a.mkv","sha256":"0a1b","frames":2,"fps":null},"warnings":["\\u00e9"]}')
    put("run_file", "two-stage", b"\0" + (work / "run/run.mgj").read_bytes()[16:])


def pictures(work):
    raw = ["-c:v", "rawvideo"]
    put("stored_video", "grey.avi", film(work, "g.avi", *raw, "-pix_fmt", "gray"))
    put("stored_video", "420.avi", film(work, "y.avi", *raw, "-pix_fmt", "yuv420p"))
    put("stored_video", "grey.mkv", film(work, "g.mkv", *raw, "-pix_fmt", "gray", "-allow_raw_vfw", 1))
    put("stored_video", "grey12.avi", film(work, "g12.avi", *raw, "-pix_fmt", "gray12le"))
    put("stored_video", "420.mkv", film(work, "y.mkv", *raw, "-pix_fmt", "yuv420p"))
    for name, options in {"raw": ["-pix_fmt", "gray", "-compression_algo", "raw"],
                          "packbits": ["-pix_fmt", "gray", "-compression_algo", "packbits"],
                          "lzw16": ["-pix_fmt", "gray16le", "-compression_algo", "lzw"],
                          "raw16": ["-pix_fmt", "gray16le", "-compression_algo", "raw"],
                          "deflate-rgb": ["-pix_fmt", "rgb24", "-compression_algo", "deflate"]}.items():
        put("tiff_picture", f"{name}.tiff", film(work, f"{name}.tiff", *options, frames=1))
    for kind in ["gray", "gray16be", "rgb24", "pal8", "ya8", "monob"]:
        put("png_picture", f"{kind}.png", film(work, f"{kind}.png", "-pix_fmt", kind, frames=1))
    put("jpeg_picture", "420.jpg", film(work, "y.jpg", "-pix_fmt", "yuvj420p", frames=1))
    put("jpeg_picture", "grey.jpg", film(work, "g.jpg", "-pix_fmt", "gray", "-color_range", "pc", frames=1))
    exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"
    jpeg = (work / "g.jpg").read_bytes()
    put("jpeg_picture", "turned.jpg", jpeg[:2] + b"\xff\xe1" + (len(exif) + 2).to_bytes(2, "big") + exif + jpeg[2:])
    put("jpeg_picture", "exif", exif)


def views(work):
    frame = work / "rig/frames/000000.png"
    markers("rig", grey_of(frame, work, scale=0.18))
    markers("circle", grey_of(frame, work, scale=0.5, crop=(90, 90, 192, 104)), words=1)
    markers("checker", grey_of(REAL / "handheld-chess/left01.jpg", work, scale=0.25, crop=(220, 60, 360, 240)))
    markers("dots", grey_of(REAL / "robot-circles/0.png", work, scale=0.25, crop=(0, 0, 480, 320)))
    square = [(100, 60), (900, 60), (100, 310), (900, 310)]
    def circles(places):
        return b"".join(int(16 * x).to_bytes(2, "big") + int(16 * y).to_bytes(2, "big") + bytes([39]) for x, y in places)
    put("identity", "four", b"\0" + circles(square))
    put("identity", "six-and-others", b"\2" + circles(square + [(100, 185), (900, 185), (500, 180), (420, 100), (600, 250)]))
    put("identity", "grid", b"\4" + circles((60 * i, 60 * k) for i in range(6) for k in range(5)))


def hevc(work):
    """Writes seeds of HEVC headers: the length of the extradata in one byte, the extradata, one packet."""
    params = ["-c:v", "libx265", "-pix_fmt", "yuv420p", "-x265-params", "log-level=none:qp=30:slices=2:weightb=1:info=0"]
    put("hevc_headers", "start-codes", bytes([0]) + film(work, "film.hevc", *params, frames=3))
    boxes = film(work, "film.mp4", *params, frames=3)
    at = boxes.index(b"hvcC")
    extradata = boxes[at + 4:at - 4 + int.from_bytes(boxes[at - 4:at], "big")]
    packets = run("ffmpeg", "-loglevel", "error", "-i", "film.mp4", "-map", "0:v", "-c", "copy", "-f", "data", "-", cwd=work)
    put("hevc_headers", "lengths", bytes([len(extradata)]) + extradata + packets)


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        texts(pathlib.Path(sys.argv[1]).resolve(), work)
        pictures(work)
        views(work)
        hevc(work)


if __name__ == "__main__":
    main()
