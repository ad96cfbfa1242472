"""Starts `moiregauge serve` and talks to it over raw sockets."""
import atexit
import json
import pathlib
import re
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import threading
import time


def insist(condition, message):
    if not condition:
        sys.exit(message)


def make_clip(program, folder, name, frames, loops=1, threads=2):
    """Renders a clip with known movement, and repeats it. H.264, so it is decoded."""
    made = folder.parent / (name + ".simulated")
    subprocess.run([program, "simulate", "small-1x", "--frames", str(frames), "--markers-only", "--codec", "x264", "--quality", "12",
                    "--threads", str(threads), "--quiet", "-o", made], check=True)
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    subprocess.run(["ffmpeg", "-loglevel", "error", "-stream_loop", str(loops - 1), "-i", made / "video.mp4", "-c", "copy", folder / name], check=True)
    shutil.rmtree(made)


class Answer:
    def __init__(self, raw):
        head, _, self.body = raw.partition(b"\r\n\r\n")
        lines = head.decode("latin-1").split("\r\n")
        self.status = int(lines[0].split()[1]) if lines[0].startswith("HTTP/1.1 ") else 0
        self.headers = {name.lower(): value for name, _, value in (line.partition(": ") for line in lines[1:])}

    @property
    def json(self):
        return json.loads(self.body)


class Server:
    def __init__(self, program, folder, *options, tls=None):
        self.process = subprocess.Popen([program, "serve", str(folder), "--port", "0", *map(str, options)] if tls is None else
                                        [program, "serve", str(folder), *map(str, options)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)  # after a failed check
        self.url = self.process.stdout.readline().strip()
        insist("://" in self.url, "no address: " + self.url)
        self.port = int(re.search(r":(\d+)/", self.url).group(1))
        self.tls = tls
        self.host = f"127.0.0.1:{self.port}"
        found = re.search(r"#token=(\w+)", self.url) or re.search(rb'name="moiregauge-token" content="(\w+)"', self.get("/").body)
        self.token = found.group(1) if isinstance(found.group(1), str) else found.group(1).decode()

    def connect(self, timeout=10):
        plain = socket.create_connection(("127.0.0.1", self.port), timeout=timeout)
        return self.tls.wrap_socket(plain, server_hostname="localhost") if self.tls else plain

    def raw(self, data, timeout=10, keep=False):
        """Sends bytes and returns all that comes until the server closes, or one whole answer."""
        with self.connect(timeout) as link:
            try:
                link.sendall(data)
            except OSError:  # refused before it was read
                pass
            return receive(link, until_closed=keep)

    def request(self, method, path, body=b"", headers=(), token=True, timeout=10):
        if isinstance(body, (dict, list)):
            body = json.dumps(body).encode()
        lines = {"Host": self.host, "Connection": "close"}
        if token:
            lines["X-Moiregauge-Token"] = self.token
        if method == "POST":
            lines |= {"Content-Type": "application/json", "Content-Length": str(len(body))}
        lines |= dict(headers)
        text = f"{method} {path} HTTP/1.1\r\n" + "".join(f"{name}: {value}\r\n" for name, value in lines.items() if value is not None) + "\r\n"
        return Answer(self.raw(text.encode("utf-8", "surrogateescape") + body, timeout))

    def get(self, path, **more):
        more.setdefault("token", hasattr(self, "token"))
        return self.request("GET", path, **more)

    def post(self, path, body, **more):
        return self.request("POST", path, body, **more)

    def is_alive(self):
        return self.process.poll() is None and self.get("/api/session").status == 200

    def stop(self, timeout=40):
        self.process.send_signal(signal.SIGINT)
        out, err = self.process.communicate(timeout=timeout)
        return self.process.returncode, out + err

    def wait_for_job(self, job, states=("done", "failed", "cancelled"), timeout=120):
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            for known in self.get("/api/jobs").json["jobs"]:
                if known["id"] == job and known["state"] in states:
                    return known
            time.sleep(0.05)
        sys.exit(f"job {job} did not reach {states}")


class Events(threading.Thread):
    """Collects the events of a server with their times."""

    def __init__(self, server):
        super().__init__(daemon=True)
        self.link = server.connect(60)
        self.link.sendall(f"GET /api/events HTTP/1.1\r\nHost: {server.host}\r\nX-Moiregauge-Token: {server.token}\r\n\r\n".encode())
        self.events = []
        self.start()

    def run(self):
        rest = b""
        while True:
            try:
                piece = self.link.recv(1 << 16)
            except OSError:
                return
            if not piece:
                return
            *blocks, rest = (rest + piece).split(b"\n\n")
            for block in blocks:
                lines = block.decode().split("\n")
                if len(lines) == 2 and lines[0].startswith("event: "):
                    self.events.append((time.monotonic(), lines[0][7:], json.loads(lines[1][6:])))

    def of(self, kind):
        return [(when, data) for when, name, data in list(self.events) if name == kind]


def receive(link, until_closed=False):
    got = b""
    while True:
        try:
            piece = link.recv(1 << 16)
        except (TimeoutError, socket.timeout):
            return got
        except OSError:
            return got
        if not piece:
            return got
        got += piece
        head, found, body = got.partition(b"\r\n\r\n")
        length = re.search(rb"\r\nContent-Length: (\d+)", head)
        if not until_closed and found and length and len(body) >= int(length.group(1)):
            return got


def tls_files(folder):
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", "/CN=localhost",
                    "-addext", "subjectAltName=DNS:localhost", "-keyout", folder / "key.pem", "-out", folder / "certificate.pem"],
                   check=True, capture_output=True)
    trust = ssl.create_default_context(cafile=folder / "certificate.pem")
    return folder / "certificate.pem", folder / "key.pem", trust


def start():
    program, work = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(work, ignore_errors=True)
    (work / "folder").mkdir(parents=True)
    return program, work, work / "folder"
