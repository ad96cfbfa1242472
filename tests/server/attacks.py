#!/usr/bin/python3
"""Attacks `moiregauge serve` over raw sockets. None may succeed, and the server answers after each.

    attacks.py MOIREGAUGE WORK

Each case has a name, what it sends, and the statuses that refuse it. A secret file lies outside the folder: no answer may
contain its text.
"""
import json
import os
import socket
import time

from serving import Answer, Server, insist, make_clip, receive, start, tls_files

program, work, folder = start()
SECRET = b"the-secret-outside-the-folder"
(work / "secret.csv").write_bytes(SECRET)
(work / "outside").mkdir()
(work / "outside/run.json").write_bytes(b'{"input":{"path":"' + SECRET + b'"}}')
make_clip(program, folder, "a.mp4", 3)
(folder / ".hidden.csv").write_bytes(SECRET)
(folder / "note.csv").write_text("t,x\n0,1\n")
os.symlink(work / "secret.csv", folder / "link.csv")
os.symlink(work / "outside", folder / "linked")
os.symlink("/proc/self/root" + str(work), folder / "magic")
os.symlink("..", folder / "up")
os.mkfifo(folder / "pipe.csv")
EVIL = "<img src=x onerror=alert(1)>.csv"
(folder / EVIL).write_text("t,x\n0,1\n")
server = Server(program, folder)
TOKEN = ("X-Moiregauge-Token: " + server.token + "\r\n").encode()
HOST = ("Host: " + server.host + "\r\n").encode()
REFUSED = (400, 403, 404, 405, 408, 409, 411, 413, 414, 415, 417, 422, 431, 501, 505)
cases = 0


def check(name, answer, statuses=REFUSED):
    global cases
    cases += 1
    insist(answer.status in statuses, f"{name}: status {answer.status}, not one of {statuses}: {answer.body[:200]}")
    insist(SECRET not in answer.body, f"{name}: the secret was served")
    if answer.status >= 400:
        insist(answer.headers.get("content-type") == "application/json" and "error" in answer.json, f"{name}: the error is not JSON")
        insist(answer.headers.get("x-content-type-options") == "nosniff", f"{name}: no nosniff")
    is_json = answer.headers.get("content-type") == "application/json"
    insist(not is_json or b"<" not in answer.body, f"{name}: an answer in JSON contains '<'")
    insist(server.is_alive(), f"{name}: the server is dead")


def raw(name, data, statuses=REFUSED, timeout=10):
    check(name, Answer(server.raw(data, timeout)), statuses)


def get(name, path, statuses=REFUSED, **more):
    check(name, server.get(path, **more), statuses)


def post(name, path, body, statuses=REFUSED, **more):
    check(name, server.post(path, body, **more), statuses)


def senders():
    """Requests of other pages, and of pages whose name was made to point here."""
    for host in ("evil.example", f"evil.example:{server.port}", f"127.0.0.1.evil.example:{server.port}", f"localhost.evil:{server.port}",
                 f"127.0.0.1:{server.port + 1}", "127.0.0.1", f"[::1", f"user@127.0.0.1:{server.port}", f"127.1.evil:{server.port}", ""):
        get(f"rebinding by Host {host!r}", "/api/entries", headers={"Host": host})
    get("rebinding of the page", "/", headers={"Host": f"evil.example:{server.port}"})
    for origin in ("http://evil.example", "null", f"https://127.0.0.1:{server.port}", f"http://127.0.0.1:{server.port + 1}", f"http://localhost:{server.port}"):
        get(f"Origin {origin}", "/api/entries", headers={"Origin": origin})
    get("cross-site fetch", "/api/entries", headers={"Sec-Fetch-Site": "cross-site"})
    get("same-site fetch", "/api/entries", headers={"Sec-Fetch-Site": "same-site"})
    get("no token", "/api/entries", token=False)
    for wrong in ("", "x", server.token[:-1], server.token + "0", server.token.upper() + " ", "0" * 64):
        get(f"token {wrong[:6]!r}...", "/api/entries", token=False, headers={"X-Moiregauge-Token": wrong})
    get("token in the address", f"/api/entries?token={server.token}", token=False)
    get("token in a cookie", "/api/entries", token=False, headers={"Cookie": f"X-Moiregauge-Token={server.token}"})
    post("form without a token", "/api/jobs", b"action=measure", token=False, headers={"Content-Type": "application/x-www-form-urlencoded"})
    post("form with a token", "/api/jobs", b"action=measure", headers={"Content-Type": "application/x-www-form-urlencoded"})
    post("text as JSON", "/api/jobs", b'{"action":"measure","arguments":["a.mp4"]}', headers={"Content-Type": "text/plain"})
    raw("preflight", b"OPTIONS /api/jobs HTTP/1.1\r\n" + HOST + b"Origin: http://evil.example\r\nAccess-Control-Request-Method: POST\r\n\r\n")
    answer = server.get("/", headers={"Connection": "close"})
    insist("access-control-allow-origin" not in answer.headers, "CORS header")
    insist("default-src 'none'" in answer.headers["content-security-policy"], "no content security policy")


def paths():
    """Paths that lead outside, in every parameter and encoding."""
    outside = ["../secret.csv", "..%2fsecret.csv", "%2e%2e/secret.csv", "%2e%2e%2fsecret.csv", "..%5csecret.csv", "....//secret.csv", "/etc/passwd",
               "%2fetc%2fpasswd", str(work / "secret.csv"), "link.csv", "linked/run.json", "magic/secret.csv", "up/secret.csv", "./a.mp4", "a.mp4/..",
               "sub//a.mp4", "a.mp4%00.csv", "%c0%ae%c0%ae/secret.csv", "..%c0%afsecret.csv", "%252e%252e%252fsecret.csv", ".hidden.csv", ".", "..", "", "%ff%fe", "a%0d%0aX-Bad:1",
               "pipe.csv", "/proc/self/environ", "proc/self/root", "~/.bashrc", "file:///etc/passwd", "http://127.0.0.1/", "-o", "x" * 3000]
    for path in outside:
        get(f"file {path[:30]}", f"/api/file?path={path}")
    for path in ("../secret.csv", "link.csv", "up/folder/a.mp4", "/etc/passwd", ".hidden.csv"):
        for address in (f"/api/frame?path={path}", f"/api/thumbnail?path={path}", f"/api/run?run={path}", f"/api/series?run={path}&marker=T1",
                        f"/api/run-frame?run={path}&frame=0", f"/api/run-markers?run={path}&frame=0", f"/api/file?run={path}&name=run.json", f"/api/batch?folder={path}"):
            get(address[:60], address)
    get("run through a link", "/api/run?run=linked")
    get("name with a path", "/api/file?run=.&name=../secret.csv")
    for body in ({"path": "../secret.csv"}, {"path": "link.csv"}, {"path": "/etc/passwd"}, {"path": ""}, {"path": "a.mp4", "site": "[grating]\npitch_mm = 10\n[x]\n"}):
        post(f"inspect {body}", "/api/inspect", body)
    for path in ("../x", "link", "/elsewhere/x", ".x", "linked/x.mp4", "up/a.mp4"):
        post(f"site of {path}", "/api/site", {"path": path, "text": "[grating]\npitch_mm = 10\n"})
    post("report outside", "/api/ticket", {"run": "linked", "name": "report.html"})
    post("ticket for another file", "/api/ticket", {"run": "linked", "name": "../../secret.csv"})
    get("guessed ticket", "/report/" + "0" * 32, token=False)
    get("ticket with a path", "/report/..%2f..%2fsecret.csv", token=False)


def commands():
    """Arguments of commands."""
    def job(name, action, *arguments):
        post(f"job {name}", "/api/jobs", {"action": action, "arguments": list(arguments)})

    job("shell", "measure", "a.mp4; touch pwned")
    job("substitution", "measure", "$(touch pwned)", "--pitch", "10mm")
    job("input outside", "measure", "../secret.csv", "--pitch", "10mm")
    job("input by link", "measure", "link.csv", "--pitch", "10mm")
    job("output outside", "measure", "a.mp4", "--pitch", "10mm", "-o", "../out")
    job("output absolute", "measure", "a.mp4", "--pitch", "10mm", "-o", str(work / "out"))
    job("output by link", "measure", "a.mp4", "--pitch", "10mm", "-o", "linked/out")
    job("output joined", "measure", "a.mp4", "--pitch", "10mm", f"--out={work}/out")
    job("short option joined", "measure", "a.mp4", "--pitch", "10mm", f"-o{work}/out")
    job("option not listed", "live", "a.mp4", "--publish", "http://evil.example/")
    job("site outside", "measure", "a.mp4", "--site", "../secret.csv")
    job("camera outside", "measure", "a.mp4", "--pitch", "10mm", "--camera", "/etc/passwd")
    job("value that is an option", "measure", "a.mp4", "--pitch", "--help")
    job("option as a value of -o", "measure", "a.mp4", "-o", "--restart")
    job("another program", "/bin/sh", "-c", "id")
    job("help", "help", "measure")
    job("serve", "serve", ".")
    job("simulate", "simulate", "small-1x")
    job("export over a clip", "export", "a.mp4", "--replace", "-o", "a.mp4")
    job("control characters", "measure", "a.mp4", "--pitch", "10mm\n--out=/tmp")
    job("NUL", "measure", "a.mp4\0", "--pitch", "10mm")
    job("pattern", "measure", "--sequence", "/etc/%s")
    job("empty argument", "measure", "")
    job("many arguments", "measure", *(["a.mp4"] * 5000))
    post("live source outside", "/api/live", {"source": "../secret.csv", "arguments": ["--pitch", "10mm"]})
    post("live source is a device", "/api/live", {"source": "v4l2:/dev/video0", "arguments": []})
    post("live listens", "/api/live", {"source": "a.mp4", "arguments": ["--listen", "0.0.0.0:1"]})
    for id in ("0", "-1", "..", "999999999999999999999", "%00", "1%2fcancel"):
        post(f"cancel {id}", f"/api/jobs/{id}/cancel", {})
    post("resume nothing", "/api/jobs/7/resume", {})
    insist(not (folder / "pwned").exists() and not (work / "out").exists(), "a command got out")


def bodies():
    """Bodies that are no JSON object."""
    for name, body in {"empty": b"", "array": b"[]", "text": b'"x"', "null": b"null", "number": b"1e999", "half": b'{"path":', "two": b"{}{}",
                       "repeated key": b'{"path":"a.mp4","path":"link.csv"}', "unknown key": b'{"path":"a.mp4","__proto__":{}}', "bad UTF-8": b'{"path":"\xff\xfe"}',
                       "lone surrogate": b'{"path":"\\ud800"}', "NUL": b'{"path":"a\\u0000b"}', "deep": b'{"path":' + b"[" * 50000 + b"]" * 50000 + b"}",
                       "deep objects": b'{"a":' * 5000 + b"1" + b"}" * 5000, "wrong type": b'{"path":1}', "long number": b'{"path":"a.mp4","frame":' + b"9" * 5000 + b"}",
                       "negative frame": b'{"path":"a.mp4","frame":-1}', "comments": b'/**/{"path":"a.mp4"}', "BOM and garbage": b"\xef\xbb\xbf{]"}.items():
        post(f"body {name}", "/api/inspect", body)
        post(f"job body {name}", "/api/jobs", body)
    post("body over the limit", "/api/inspect", b"{" + b" " * 300000 + b"}", (413,))
    post("regions without end", "/api/inspect", {"path": "a.mp4", "pitch": "10mm", "exclude": [[0, 0, 1, 1]] * 20000})
    post("pitch of script", "/api/inspect", {"path": "a.mp4", "pitch": "<script>alert(1)</script>"})
    post("name of script", "/api/inspect", {"path": "a.mp4", "pitch": "10mm", "names": {"T1": "<script>"}}, (200,))
    post("unknown marker of script", "/api/inspect", {"path": "a.mp4", "pitch": "10mm", "ignore": ["</script><script>"]})


def uploads():
    """Uploads that would escape, replace, lie or fill the disk."""
    def upload(name, query, body=b"x", statuses=REFUSED):
        check(f"upload {name}", server.post("/api/upload?" + query, body, headers={"Content-Type": "application/octet-stream"}), statuses)

    for name in ("../x.mp4", "..%2fx.mp4", "/elsewhere/x.mp4", "%00x.mp4", ".x.mp4", "a/b/c.mp4", "linked/x.mp4", "up/x.mp4", "x.html", "x.js", "x.mgj", "run.json", "x",
                 "x.mp4%0d%0a", "x" * 250 + ".mp4", ""):
        upload(name[:20], f"name={name}&offset=0&size=1")
    upload("over a clip", "name=a.mp4&offset=0&size=1", statuses=(409,))
    upload("over a link", "name=link.csv&offset=0&size=1", statuses=(409,))
    upload("offset ahead", "name=n.mp4&offset=5&size=10", statuses=(409,))
    upload("more than stated", "name=n.mp4&offset=0&size=2", b"12345")
    upload("negative size", "name=n.mp4&offset=0&size=-1")
    upload("overflow", "name=n.mp4&offset=0&size=99999999999999999999")
    upload("too large", "name=n.mp4&offset=0&size=99999999999999", statuses=(413,))
    upload("no size", "name=n.mp4&offset=0")
    raw("piece over the limit", b"POST /api/upload?name=n.mp4&offset=0&size=999999999 HTTP/1.1\r\n" + HOST + TOKEN + b"Content-Length: 100000000\r\n\r\n", (413,))
    insist(not list(folder.glob("n.mp4")), "an incomplete upload is visible")
    insist((folder / "a.mp4").stat().st_size > 100, "a clip was replaced")


def messages():
    """Requests that two readers could understand differently, and malformed ones."""
    line = b"GET /api/session HTTP/1.1\r\n"
    end = b"\r\n"
    both = b"POST /api/jobs HTTP/1.1\r\n" + HOST + TOKEN + b"Content-Type: application/json\r\n"
    for name, data in {
            "length and chunks": both + b"Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
            "chunks": both + b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n", "obscure chunks": both + b"Transfer-Encoding: xchunked\r\nContent-Length: 2\r\n\r\n{}",
            "two lengths": both + b"Content-Length: 2\r\nContent-Length: 2\r\n\r\n{}", "list of lengths": both + b"Content-Length: 2, 2\r\n\r\n{}",
            "signed length": both + b"Content-Length: +2\r\n\r\n{}", "negative length": both + b"Content-Length: -1\r\n\r\n", "hexadecimal length": both + b"Content-Length: 0x2\r\n\r\n{}",
            "huge length": both + b"Content-Length: 99999999999999999999\r\n\r\n", "no length": both + end, "length of a GET": line + HOST + TOKEN + b"Content-Length: 5\r\n\r\nhello",
            "space before the colon": line + HOST + TOKEN + b"Content-Length : 0\r\n\r\n", "folded line": line + HOST + TOKEN + b"X: a\r\n b\r\n\r\n", "bare line feed": line + HOST + TOKEN + b"X: a\nY: b\r\n\r\n",
            "bare carriage return": line + HOST + TOKEN + b"X: a\rY: b\r\n\r\n", "NUL in a header": line + HOST + TOKEN + b"X: a\0b\r\n\r\n", "control in a header": line + HOST + TOKEN + b"X: a\x1bb\r\n\r\n",
            "no name": line + HOST + TOKEN + b": x\r\n\r\n", "no colon": line + HOST + TOKEN + b"hello\r\n\r\n", "two hosts": line + HOST + HOST + TOKEN + end, "no host": line + TOKEN + end,
            "two tokens": line + HOST + TOKEN + TOKEN + end, "absolute target": b"GET http://evil.example/ HTTP/1.1\r\n" + HOST + TOKEN + end, "authority": b"CONNECT evil.example:443 HTTP/1.1\r\n" + HOST + end,
            "HTTP/1.0": b"GET / HTTP/1.0\r\n" + HOST + end, "HTTP/0.9": b"GET /\r\n\r\n", "HTTP/2 preface": b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", "HTTP/1.11": b"GET / HTTP/1.11\r\n" + HOST + end,
            "tab for a space": b"GET\t/\tHTTP/1.1\r\n" + HOST + end, "extra space": b"GET  / HTTP/1.1\r\n" + HOST + end, "no target": b"GET HTTP/1.1\r\n" + HOST + end, "fragment": b"GET /#x HTTP/1.1\r\n" + HOST + end,
            "half an escape": b"GET /api/file?path=%2 HTTP/1.1\r\n" + HOST + TOKEN + end, "repeated parameter": b"GET /api/file?path=note.csv&path=link.csv HTTP/1.1\r\n" + HOST + TOKEN + end,
            "many parameters": b"GET /api/file?" + b"&".join(b"p%d=1" % k for k in range(1000)) + b" HTTP/1.1\r\n" + HOST + TOKEN + end, "long target": b"GET /" + b"a" * 9000 + b" HTTP/1.1\r\n" + HOST + end,
            "long head": line + HOST + TOKEN + b"X: " + b"a" * 20000 + b"\r\n\r\n", "header flood": line + HOST + TOKEN + b"".join(b"X%d: 1\r\n" % k for k in range(500)) + end,
            "unknown method": b"BREW / HTTP/1.1\r\n" + HOST + end, "TRACE": b"TRACE / HTTP/1.1\r\n" + HOST + end, "DELETE": b"DELETE /api/entries HTTP/1.1\r\n" + HOST + TOKEN + end,
            "PUT": b"PUT /api/site HTTP/1.1\r\n" + HOST + TOKEN + b"Content-Length: 0\r\n\r\n", "method in lower case": b"get / HTTP/1.1\r\n" + HOST + end, "override": b"GET /api/jobs/1/cancel HTTP/1.1\r\n" + HOST + TOKEN + b"X-HTTP-Method-Override: POST\r\n\r\n",
            "GET of a POST": b"GET /api/inspect HTTP/1.1\r\n" + HOST + TOKEN + end, "POST of a GET": b"POST /api/entries HTTP/1.1\r\n" + HOST + TOKEN + b"Content-Length: 0\r\n\r\n",
            "unknown expectation": both + b"Content-Length: 2\r\nExpect: magic\r\n\r\n{}", "upgrade to a socket": b"GET /api/events2 HTTP/1.1\r\n" + HOST + TOKEN + b"Upgrade: websocket\r\nConnection: Upgrade\r\n\r\n",
            "TLS to a plain port": b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"\0" * 20 + b"\r\n\r\n", "noise": bytes(range(256)) * 8 + b"\r\n\r\n"}.items():
        raw(name, data)
    smuggled = b"POST /api/jobs/1/cancel HTTP/1.1\r\n" + HOST + TOKEN + b"Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}" + line + HOST + end
    got = server.raw(smuggled, 3, keep=True)
    insist(got.count(b"HTTP/1.1 ") == 2 and b"HTTP/1.1 403" in got, "the request behind a body was not checked by itself")


def ranges():
    """Range is not offered: answers are whole."""
    for value in ("bytes=0-0,1-1,2-2," + ",".join(f"{k}-{k}" for k in range(500)), "bytes=-1", "bytes=99999999999-", "bytes=0-18446744073709551615", "lines=1-2"):
        check(f"Range {value[:20]}", server.get("/api/file?path=note.csv", headers={"Range": value}), (200,))


def texts():
    """File names are text, never markup."""
    answer = server.get("/api/entries")
    insist(EVIL.encode() not in answer.body and EVIL in [entry["path"] for entry in answer.json["entries"]], "a file name is served as markup")
    check("download of markup", server.get("/api/file?path=%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E.csv"), (200,))
    answer = server.get("/api/file?path=%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E.csv")
    insist("<" not in answer.headers["content-disposition"] and answer.headers["content-type"] == "application/octet-stream", "the download is markup")
    get("path of script", "/%3Cscript%3Ealert(1)%3C/script%3E")
    get("hidden in the listing", "/api/file?path=.hidden.csv")
    listed = [entry["path"] for entry in answer_entries()]
    insist(not [path for path in listed if path.startswith(".") or path.startswith(("linked", "up", "magic", "link.csv"))], f"links or hidden files are listed: {listed}")


def answer_entries():
    return server.get("/api/entries").json["entries"]


def slow_clients():
    """A thousand connections that do nothing, and some that send a byte now and then."""
    idle = []
    for _ in range(1000):
        link = socket.socket()
        link.settimeout(5)
        link.connect(("127.0.0.1", server.port))
        idle.append(link)
    begin = time.monotonic()
    for link in idle[:200]:
        link.sendall(b"GET / HTTP/1.1\r\nHost: ")
    for link in idle[200:240]:
        link.sendall(b"POST /api/inspect HTTP/1.1\r\n" + HOST + TOKEN + b"Content-Type: application/json\r\nContent-Length: 200000\r\n\r\n{")
    insist(server.is_alive(), "a thousand idle connections block the server")
    taken = time.monotonic() - begin
    insist(taken < 2.0, f"with a thousand idle connections an answer takes {taken:.1f} s")
    check("a thousand idle connections", server.get("/api/entries"), (200,))
    streams = []
    for _ in range(40):
        link = server.connect(3)
        link.sendall(b"GET /api/events HTTP/1.1\r\n" + HOST + TOKEN + b"\r\n")
        streams.append(link)
    refused = sum(b"503" in link.recv(4096)[:20] for link in streams)
    insist(refused == 24, f"{refused} of 40 event streams were refused, not 24")
    check("forty event streams", server.get("/api/session"), (200,))
    # A head must be complete within ten seconds, however regularly its bytes come.
    drip = idle[0]
    end = time.monotonic() + 14
    closed = None
    while time.monotonic() < end and closed is None:
        try:
            drip.sendall(b"a")
            drip.settimeout(0.2)
            if drip.recv(100) == b"":
                closed = time.monotonic()
        except (TimeoutError, socket.timeout):
            continue
        except OSError:
            closed = time.monotonic()
    insist(closed is not None and closed - begin < 13, "a head that never ends keeps its connection")
    check("slow head", server.get("/api/session"), (200,))
    for link in idle + streams:
        link.close()
    # Clients that never read their answers.
    deaf = []
    for _ in range(30):
        link = server.connect()
        link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        link.sendall((b"GET /app.js HTTP/1.1\r\n" + HOST + b"\r\n") * 50)
        deaf.append(link)
    check("clients that do not read", server.get("/api/session"), (200,))
    for link in deaf:
        link.close()
    for _ in range(200):
        link = server.connect()
        link.sendall(b"GET /api/entries HTTP/1.1\r\n" + HOST + TOKEN + b"\r\n")
        link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
        link.close()  # resets
    check("resets", server.get("/api/session"), (200,))


def beyond_loopback():
    """With --listen: TLS, and the token is not in the page."""
    certificate, key, trust = tls_files(work)
    far = Server(program, folder, "--listen", "127.0.0.1:0", "--certificate", certificate, "--key", key, tls=trust)
    global server
    near, server = server, far
    far.host = f"localhost:{far.port}"
    check("TLS with the token", far.get("/api/session"), (200,))
    page = far.get("/", token=False)
    insist(far.token.encode() not in page.body, "the page beyond this computer contains the token")
    check("TLS without the token", far.get("/api/session", token=False), (403,))
    check("TLS, foreign host", far.get("/api/session", headers={"Host": f"evil.example:{far.port}"}), (403,))
    with socket.create_connection(("127.0.0.1", far.port), timeout=5) as link:
        link.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
        insist(not receive(link).startswith(b"HTTP/"), "plain HTTP was answered on the TLS port")
    check("plain HTTP on the TLS port", far.get("/api/session"), (200,))
    silent = [socket.create_connection(("127.0.0.1", far.port), timeout=5) for _ in range(200)]
    check("200 handshakes that never begin", far.get("/api/session"), (200,))
    for link in silent:
        link.close()
    code, text = far.stop()
    insist(code == 0, f"exit {code}: {text}")
    server = near


for group in senders, paths, commands, bodies, uploads, messages, ranges, texts, slow_clients, beyond_loopback:
    begin = time.monotonic()
    group()
    print(f"{group.__name__}: {time.monotonic() - begin:.1f} s, {cases} cases so far", flush=True)
code, text = server.stop()
insist(code == 0, f"exit {code} after the attacks: {text}")
insist(cases >= 60, "fewer than 60 cases")
print(f"{cases} attacks, none succeeded")
