#!/usr/bin/env python3
"""Runs `moiregauge serve` under the thread sanitizer.

    serve.py MOIREGAUGE WORK_DIR

Several clients ask for pictures, entries and results at the same time, while commands run, an upload arrives and pages follow the
events. A race ends the server or one of its commands with exit code 66.
"""
import pathlib
import signal
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "server"))
from serving import Events, Server, make_clip, start, tls_files  # noqa: E402

from races import Races  # noqa: E402

program, work, folder = start()
insist = Races(work).insist
TIMEOUT = 120  # s; everything takes about ten times as long here
CLIENTS = 4
OCTETS = {"Content-Type": "application/octet-stream"}


class Clients:
    """Sends the same requests again and again, on several connections at once. Any answer but the expected ones is a failure."""

    def __init__(self, server, requests):
        self.server, self.requests, self.stop, self.failures, self.answers = server, requests, threading.Event(), [], 0
        self.threads = [threading.Thread(target=self.run, args=(n,), daemon=True) for n in range(CLIENTS)]
        for thread in self.threads:
            thread.start()

    def run(self, n):
        at = n * len(self.requests) // CLIENTS  # each begins with another one
        while not self.stop.is_set():
            method, path, body, statuses = self.requests[at % len(self.requests)]
            answer = self.server.request(method, path, body, timeout=TIMEOUT)
            if answer.status not in statuses:
                self.failures.append((path, answer.status, answer.body[:200]))
            self.answers += 1
            at += 1

    def end(self):
        self.stop.set()
        for thread in self.threads:
            thread.join(TIMEOUT)
        insist(not self.failures, f"{len(self.failures)} of {self.answers} answers: {self.failures[:3]}")
        insist(self.answers > 2 * len(self.requests), f"{self.answers} answers")


def post(server, path, body):
    answer = server.post(path, body, timeout=TIMEOUT)
    insist(answer.status in (200, 201, 202), f"{path}: {answer.status} {answer.body}")
    return answer.json


def job(server, action, *arguments):
    return post(server, "/api/jobs", {"action": action, "arguments": list(arguments)})


def ended(server, known, *states):
    done = server.wait_for_job(known["id"], timeout=600)
    insist(done["state"] in states, f"{done} is not {states}")
    return done


def until(condition, what, seconds=300):
    end = time.monotonic() + seconds
    while not condition():
        insist(time.monotonic() < end, f"not within {seconds} s: {what}")
        time.sleep(0.02)


def frames_done(server, known):
    jobs = {one["id"]: one for one in server.get("/api/jobs", timeout=TIMEOUT).json["jobs"]}
    insist(jobs[known["id"]]["state"] in ("queued", "running"), jobs[known["id"]])
    return jobs[known["id"]]["frames_done"]


def upload(server, name, data, piece):
    """Two clients send the same file at the same time, as two pages would. Each continues where the file is."""
    def send():
        at = 0
        while at < len(data):
            end = min(at + piece, len(data))
            answer = server.post(f"/api/upload?name={name}&offset={at}&size={len(data)}", data[at:end], headers=OCTETS, timeout=TIMEOUT)
            if answer.status == 200:
                at = answer.json["received"]
                continue
            known = server.get(f"/api/upload?name={name}&size={len(data)}", timeout=TIMEOUT)
            if known.status != 200 or (folder / name).exists():
                return
            at = known.json["received"]
    senders = [threading.Thread(target=send, daemon=True) for _ in range(2)]
    for sender in senders:
        sender.start()
    return senders


def stop(server, number):
    server.process.send_signal(number)
    out, err = server.process.communicate(timeout=TIMEOUT)
    insist(server.process.returncode == 0, f"exit {server.process.returncode}\n{out}{err}")


def pictures(clip):
    return [("GET", path, b"", (200,)) for path in (f"/api/thumbnail?path={clip}", f"/api/frame?path={clip}&frame=5&max_width=320",
                                                    f"/api/frame?path={clip}&frame=2", "/api/entries", "/api/jobs", "/api/session", "/")]


def commands_and_pages():
    server = Server(program, folder, "--jobs", 2)
    pages = [Events(server) for _ in range(3)]
    listed = {entry["path"] for entry in server.get("/api/entries", timeout=TIMEOUT).json["entries"]}
    insist({"one.mp4", "two.mp4", "long.mp4"} <= listed, listed)
    asked = {"path": "one.mp4", "pitch": "10mm"}
    site = post(server, "/api/inspect", asked)["site"]
    post(server, "/api/site", {"path": "one.mp4", "text": site})
    clients = Clients(server, [*pictures("one.mp4"), *pictures("two.mp4"), ("POST", "/api/inspect", asked, (200,)),
                               ("GET", "/api/batch", b"", (200,)), ("GET", "/api/live", b"", (200,))])
    senders = upload(server, "sent.mp4", (folder / "long.mp4").read_bytes(), 16 << 10)
    both = job(server, "measure", "one.mp4", "--site", "one.site.toml"), job(server, "measure", "two.mp4", "--pitch", "10mm")
    cancelled = job(server, "measure", "long.mp4", "--pitch", "10mm")  # waits for the two
    for known in both:
        ended(server, known, "done")
    until(lambda: frames_done(server, cancelled) >= 3, "the third measurement")
    pages.pop().link.close()  # a page is closed while events come
    post(server, f"/api/jobs/{cancelled['id']}/cancel", {})
    ended(server, cancelled, "cancelled")
    for sender in senders:
        sender.join(TIMEOUT)
    insist((folder / "sent.mp4").read_bytes() == (folder / "long.mp4").read_bytes(), "the upload is not the file")
    clients.end()
    results(server)
    insist(all(page.of("job") and page.of("samples") and page.of("entries") for page in pages), "a page has no events")
    stop(server, signal.SIGINT)


def results(server):
    """Reads the results on several connections, while the run is solved again and another channel is derived."""
    run = "one-moiregauge"
    clients = Clients(server, [("GET", path, b"", (200,)) for path in (
        f"/api/run?run={run}", f"/api/series?run={run}&marker=T1", f"/api/run-frame?run={run}&frame=3&max_width=320", f"/api/run-markers?run={run}&frame=3",
        "/api/batch", f"/api/file?run={run}&name=displacement.csv", "/api/entries", "/api/run?run=two-moiregauge",
        "/api/run-markers?run=two-moiregauge&frame=4")] + [("POST", "/api/ticket", {"run": run, "name": "report.html"}, (200,))])
    solved = job(server, "solve", run, "-o", "solved")
    derived = job(server, "derive", "two-moiregauge", "--channel", "d = T1.dy - T1.dx")
    ended(server, solved, "done")
    ended(server, derived, "done")
    clients.end()


def live_and_a_stop_while_commands_run():
    certificate, key, trust = tls_files(work)
    server = Server(program, folder, "--listen", "127.0.0.1:0", "--certificate", certificate, "--key", key, tls=trust)
    server.host = f"localhost:{server.port}"
    pages = [Events(server) for _ in range(2)]
    source = post(server, "/api/live", {"source": "long.mp4", "arguments": ["--pitch", "10mm", "--pace", "1", "--alarm", "T1.dy > 0.1 mm"]})
    picture = f"/api/live-frame?id={source['id']}"
    clients = Clients(server, [("GET", picture, b"", (200, 404)), ("GET", "/api/live", b"", (200,)), ("GET", "/api/jobs", b"", (200,)),
                               ("GET", "/api/thumbnail?path=two.mp4", b"", (200,))])
    until(lambda: pages[0].of("samples") and server.get(picture, timeout=TIMEOUT).status == 200, "rows of the live source")
    again = job(server, "measure", "two.mp4", "--pitch", "10mm", "-o", "again")
    until(lambda: frames_done(server, again) >= 3, "a measurement next to the live source")
    late = Events(server)  # a page that opens while both run
    post(server, f"/api/live/{source['id']}/stop", {})
    ended(server, source, "done")
    clients.end()
    running = job(server, "measure", "long.mp4", "--pitch", "10mm", "-o", "stopped")
    job(server, "measure", "one.mp4", "--pitch", "10mm", "-o", "waiting")
    until(lambda: frames_done(server, running) >= 3, "a measurement that is stopped")
    insist(late.of("live") and late.of("samples"), "a page that opened later has no events")
    stop(server, signal.SIGTERM)
    insist((folder / "stopped.unfinished/run.mgj").exists() or (folder / "stopped/run.mgj").exists(), "stopping the server lost the run")


make_clip(program, folder, "one.mp4", 12, threads=1)
subprocess.run(["cp", folder / "one.mp4", folder / "two.mp4"], check=True)
subprocess.run(["ffmpeg", "-nostdin", "-loglevel", "error", "-stream_loop", "39", "-i", folder / "one.mp4", "-c", "copy", folder / "long.mp4"], check=True)
for test in commands_and_pages, live_and_a_stop_while_commands_run:
    begin = time.monotonic()
    test()
    insist(True, test.__name__)
    print(f"{test.__name__}: {time.monotonic() - begin:.1f} s", flush=True)
