"""Sources for tests of `moiregauge live`: a camera and a stream on the loopback interface. Compares their rows with the truth."""
import csv
import http.server
import subprocess
import threading
import time

from runs import insist


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class FakeCamera:
    """Aravis's camera, which shows rendered gratings. `truth` has dx and dy in mm for each shown image of one period."""

    def __init__(self, program, serial, images, lost_share):
        self.process = subprocess.Popen([program, serial, str(images), str(lost_share)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True)
        self.truth = []
        for line in self.process.stdout:
            words = line.split()
            if words[0] != "truth":
                insist(words[0] == "ready", "the fake camera could not start")
                break
            self.truth.append((float(words[2]), float(words[3])))

    def end(self):
        """Ends the camera. Returns the number of frames that it sent."""
        self.process.stdin.close()
        sent = self.process.stdout.read().split()
        self.process.wait(timeout=20)
        return int(sent[1])

    def count_wrong(self, samples, limit):
        """Returns the number of `ok` rows that are off by more than `limit` u, from the first row on.

        The first image is unknown, so the one with the fewest wrong rows is assumed.
        """
        period, zero = len(self.truth), int(samples[0]["frame"])

        def count(first):
            then = self.truth[(first + zero) % period]
            return sum(is_wrong(row, self.truth[(first + int(row["frame"])) % period], then, limit) for row in samples)
        return min(count(first) for first in range(period))


def is_wrong(row, now, then, limit):
    """Returns true if an `ok` row is off by more than `limit` u. now, then: true dx and dy in mm, of this row and of its zero."""
    if row["status"] != "ok":
        return False
    return any(float(row["u_" + axis]) > 0 and abs(float(row[axis]) - (now[k] - then[k])) > limit * float(row["u_" + axis])
               for k, axis in enumerate(("dx_mm", "dy_mm")))


def difference_of(measured, live):
    """Compares the rows of an alarm's recording with those of its run. Returns the largest difference in u, and the rows that are not ok."""
    by_time = {round(float(row["time_s"]), 3): row for row in live}
    largest, bad = 0.0, []
    for row in measured:
        same = by_time[round(float(row["time_s"]), 3)]
        if row["status"] != "ok":
            bad.append(row)
            continue
        for axis in "dx_mm", "dy_mm":
            # Both runs see the same pixels of the markers. Only the key frames of their scenes differ, which is part of u.
            difference = abs(float(row[axis]) - float(same[axis]))
            if difference > 1e-6:
                largest = max(largest, (difference - 1e-6) / max(float(same["u_" + axis]), 1e-9))
    return largest, bad


class MotionJpeg(http.server.BaseHTTPRequestHandler):
    """Sends ten frames per connection at 20 frames/s, and closes it."""
    FPS = 20
    frames = []
    connections = sent = 0

    def do_GET(self):
        MotionJpeg.connections += 1
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace;boundary=ffmpeg")
        self.end_headers()
        try:
            for jpeg in self.frames[:10]:
                self.wfile.write(b"--ffmpeg\r\nContent-type: image/jpeg\r\nContent-length: %d\r\n\r\n" % len(jpeg) + jpeg + b"\r\n")
                MotionJpeg.sent += 1
                time.sleep(1 / self.FPS)
        except OSError:
            pass

    def log_message(self, *_):
        pass


def serve_motion_jpeg(jpegs):
    MotionJpeg.frames, MotionJpeg.connections, MotionJpeg.sent = jpegs, 0, 0
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), MotionJpeg)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


def end_after_closings(server, live, closings):
    """Waits until the stream has closed `closings` times, and ends the server. Returns the errors of the run, once that ended too."""
    begin = time.monotonic()
    while MotionJpeg.connections <= closings and time.monotonic() - begin < 10 + 3 * closings:
        time.sleep(0.05)
    server.shutdown()
    server.server_close()
    return live.communicate(timeout=120)[1]
