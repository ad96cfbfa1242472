"""Controls a headless Chromium through its devtools pipe. Requires the package chromium only.

    with Browser(work) as browser:
        page = browser.open("file:///...", width=1200, height=900, dark=True)
        page.value("document.title")

Messages are JSON, each followed by a zero byte. They are written to the browser's file descriptor 3 and read from its 4
(https://chromedevtools.github.io/devtools-protocol).
"""
import base64
import json
import os
import pathlib
import select
import shutil
import subprocess
import time

CHROMIUM = "chromium"


class Browser:
    def __init__(self, work, timeout=60.0):
        """work: folder in which the browser's own files are stored."""
        self.home = pathlib.Path(work) / "chromium"
        self.timeout = timeout
        self.errors = []  # error and warning messages of all pages
        self.requests = []  # URLs requested by all pages, except their own files
        self.paused = []  # requests that the pattern of pause_requests() holds
        self.answers = {}
        self.last = 0
        self.rest = b""

    def __enter__(self):
        shutil.rmtree(self.home, ignore_errors=True)
        self.home.mkdir(parents=True)
        theirs_in, self.write_end = os.pipe()
        self.read_end, theirs_out = os.pipe()
        # The browser expects its ends of the pipes as descriptors 3 and 4.
        start = f'exec "$0" "$@" 3<&{theirs_in} 4>&{theirs_out}'
        environment = dict(os.environ, HOME=str(self.home), XDG_CONFIG_HOME=str(self.home), XDG_CACHE_HOME=str(self.home))
        for mine in ["LD_PRELOAD", "LSAN_OPTIONS"]:
            environment.pop(mine, None)
        self.process = subprocess.Popen(
            ["bash", "-c", start, CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             "--no-first-run", "--disable-extensions", "--disable-background-networking", "--disable-component-update",
             "--hide-scrollbars", f"--user-data-dir={self.home}/profile", "--remote-debugging-pipe", "about:blank"],
            pass_fds=[theirs_in, theirs_out], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=(self.home / "log").open("wb"), env=environment)
        os.close(theirs_in)
        os.close(theirs_out)
        return self

    def __exit__(self, *_):
        try:
            self.send("Browser.close")
        except (OSError, RuntimeError):
            pass
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.write_end)
        os.close(self.read_end)
        shutil.rmtree(self.home, ignore_errors=True)

    def send(self, method, session=None, **parameters):
        """Sends one command and returns its answer. Messages that arrive before the answer are stored."""
        self.last += 1
        message = {"id": self.last, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.write_end, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + self.timeout
        while self.last not in self.answers:
            self.listen(end - time.monotonic(), method)
        answer = self.answers.pop(self.last)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error'].get('message')}")
        return answer["result"]

    def downloads_to(self, folder):
        """Files that pages save go to this folder, which is emptied."""
        shutil.rmtree(folder, ignore_errors=True)
        pathlib.Path(folder).mkdir(parents=True)
        self.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder))

    def listen(self, seconds, what):
        ready, _, _ = select.select([self.read_end], [], [], max(0.0, seconds))
        if not ready:
            raise RuntimeError(f"the browser does not answer: {what}")
        data = os.read(self.read_end, 1 << 20)
        if not data:
            raise RuntimeError(f"the browser ended: {(self.home / 'log').read_text(errors='replace')[-2000:]}")
        *messages, self.rest = (self.rest + data).split(b"\0")
        for text in messages:
            message = json.loads(text)
            if "id" in message:
                self.answers[message["id"]] = message
            else:
                self.note(message.get("method"), message.get("params", {}))

    def note(self, method, parameters):
        if method == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details.get("text")))
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in parameters["args"]))
        elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            self.errors.append(f'{parameters["entry"]["text"]} {parameters["entry"].get("url", "")}'.strip())
        elif method == "Fetch.requestPaused":
            self.paused.append(parameters["requestId"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])

    def open(self, url, width=1200, height=900, dark=False, still=False):
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = Page(self, session)
        for domain in ["Page", "Runtime", "Log", "Network"]:
            page.send(f"{domain}.enable")
        page.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        page.theme(dark, still)
        page.send("Page.navigate", url=url)
        page.wait("['ready', 'failed'].includes(document.documentElement?.dataset.state)")
        self.requests = [asked for asked in self.requests if asked != url and not asked.startswith(("data:", "about:"))]
        return page


class Page:
    def __init__(self, browser, session):
        self.browser = browser
        self.session = session

    def send(self, method, **parameters):
        return self.browser.send(method, session=self.session, **parameters)

    def value(self, expression):
        """Returns the value of a JavaScript expression in the page; waits for promises."""
        done = self.send("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in done:
            raise RuntimeError(f"{expression}: {done['exceptionDetails'].get('exception', {}).get('description')}")
        return done["result"].get("value")

    def wait(self, condition, seconds=None):
        end = time.monotonic() + (seconds or self.browser.timeout)
        while not self.value(condition):
            if time.monotonic() > end:
                raise RuntimeError(f"never came true: {condition}")
            time.sleep(0.05)

    def theme(self, dark, still=False):
        self.send("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
            {"name": "prefers-reduced-motion", "value": "reduce" if still else "no-preference"}])

    def pause_requests(self, pattern):
        """Holds requests whose address matches, until fail_request() or release_requests()."""
        self.browser.paused.clear()
        self.send("Fetch.enable", patterns=[{"urlPattern": pattern}])

    def fail_request(self, seconds=20):
        """Waits for a held request and breaks its connection."""
        end = time.monotonic() + seconds
        while not self.browser.paused:
            if time.monotonic() > end:
                raise RuntimeError("no request was held")
            self.value("1")
        self.send("Fetch.failRequest", requestId=self.browser.paused.pop(0), errorReason="ConnectionReset")

    def release_requests(self):
        self.browser.paused.clear()
        self.send("Fetch.disable")

    def mouse(self, kind, x, y, modifiers=0, **more):
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, modifiers=modifiers, **more)

    def drag(self, from_x, to_x, y, modifiers=0):
        self.mouse("mouseMoved", from_x, y, modifiers)
        self.mouse("mousePressed", from_x, y, modifiers, button="left", clickCount=1, buttons=1)
        for share in (0.3, 0.7, 1.0):
            self.mouse("mouseMoved", from_x + share * (to_x - from_x), y, modifiers, button="left", buttons=1)
        self.mouse("mouseReleased", to_x, y, modifiers, button="left", clickCount=1)

    def double_click(self, x, y):
        for count in (1, 2):
            self.mouse("mousePressed", x, y, button="left", clickCount=count, buttons=1)
            self.mouse("mouseReleased", x, y, button="left", clickCount=count)

    def key(self, key):
        text = {"text": key} if len(key) == 1 else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key)

    def screenshot(self, path, whole=True):
        if whole:  # plots are drawn when they become visible
            height = min(16000, int(self.value("document.documentElement.scrollHeight")))
            width = int(self.value("innerWidth"))
            self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
            self.value("new Promise((done) => setTimeout(done, 400))")
        data = self.send("Page.captureScreenshot", format="png")["data"]
        pathlib.Path(path).write_bytes(base64.b64decode(data))

    def pdf(self, path):
        data = self.send("Page.printToPDF", preferCSSPageSize=True, printBackground=False)["data"]
        pathlib.Path(path).write_bytes(base64.b64decode(data))
