"""Debian's chromium without a screen, driven through a pipe by its DevTools protocol; every request that it makes is kept."""
import base64
import json
import os
import pathlib
import select
import shutil
import signal
import socketserver
import subprocess
import tempfile
import threading
import time

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-extensions", "--disable-default-apps", "--mute-audio"]


class Proxy(socketserver.ThreadingTCPServer):
    """What leaves the browser comes here; it answers nobody and keeps what was asked for."""
    daemon_threads = True

    class Handler(socketserver.StreamRequestHandler):
        def handle(self):
            self.server.asked.append(self.rfile.readline().decode(errors="replace").strip())

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Proxy.Handler)
        self.asked = []
        threading.Thread(target=self.serve_forever, daemon=True).start()


class Browser:
    def __init__(self, downloads):
        self.proxy = Proxy()
        self.requests = []
        self.errors = []
        self.number = 0
        self.session = None
        self.buffer = b""
        self.profile = tempfile.mkdtemp(prefix="ecs_page_")
        to_browser, self.out = os.pipe()
        self.incoming, from_browser = os.pipe()
        words = ["chromium", *FLAGS, f"--user-data-dir={self.profile}", f"--proxy-server=127.0.0.1:{self.proxy.server_address[1]}",
                 "--proxy-bypass-list=<-loopback>", "--remote-debugging-pipe", "about:blank"]
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{to_browser} 4>&{from_browser}', "chromium", *words],
            pass_fds=(to_browser, from_browser), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        os.close(to_browser)
        os.close(from_browser)
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=downloads)
        for domain in ("Page", "Runtime", "Network", "DOM", "Log", "Accessibility"):
            self.call(f"{domain}.enable")
        # Workers too: their requests are kept as those of the page are.
        self.call("Target.setAutoAttach", autoAttach=True, waitForDebuggerOnStart=True, flatten=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.killpg(self.process.pid, signal.SIGTERM)
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
        self.proxy.shutdown()
        shutil.rmtree(self.profile, ignore_errors=True)

    def send(self, method, session=None, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session or self.session:
            message["sessionId"] = session or self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.out, data):]
        return self.number

    def receive(self, seconds):
        end = time.monotonic() + seconds
        while b"\0" not in self.buffer:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.incoming], [], [], left)[0]:
                return None
            part = os.read(self.incoming, 1 << 20)
            if not part:
                raise SystemExit("chromium has ended")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def note(self, message):
        method, parameters = message.get("method"), message.get("params", {})
        if method == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description") or details["text"])
        elif method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.errors.append(parameters["entry"]["text"])
        elif method == "Target.attachedToTarget":
            session = parameters["sessionId"]
            self.send("Network.enable", session)
            self.send("Runtime.enable", session)
            self.send("Runtime.runIfWaitingForDebugger", session)

    def call(self, method, seconds=60, **parameters):
        number = self.send(method, **parameters)
        end = time.monotonic() + seconds
        while (message := self.receive(end - time.monotonic())) is not None:
            if message.get("id") == number:
                if "error" in message:
                    raise SystemExit(f"{method}: {message['error']['message']}")
                return message["result"]
            self.note(message)
        raise SystemExit(f"{method}: no answer within {seconds} s")

    def value(self, script, seconds=60):
        answer = self.call("Runtime.evaluate", seconds, expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise SystemExit(f"{script}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def wait_for(self, script, seconds=60):
        end = time.monotonic() + seconds
        while not (value := self.value(script)):
            if time.monotonic() > end:
                raise SystemExit(f"not within {seconds} s: {script}; the page says: {self.value('document.body.innerText')[:600]}")
            time.sleep(0.02)
        return value

    def processor_times(self):
        """{thread: seconds of processor time so far} of all threads of the browser"""
        times = {}
        for thread in pathlib.Path("/proc").glob("[0-9]*/task/[0-9]*/stat"):
            try:
                words = thread.read_text().rpartition(")")[2].split()
            except OSError:  # it has ended
                continue
            if int(words[3]) == self.process.pid:  # the session that begins with the browser
                times[thread.parent.name] = (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")
        return times

    def open(self, url):
        self.call("Page.navigate", url=url)
        self.wait_for("document.readyState === 'complete'")

    def choose_files(self, selector, files):
        root = self.call("DOM.getDocument")["root"]["nodeId"]
        node = self.call("DOM.querySelector", nodeId=root, selector=selector)["nodeId"]
        self.call("DOM.setFileInputFiles", nodeId=node, files=[str(one) for one in files])

    def press(self, key):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode={"Tab": 9, "Enter": 13}[key],
                      text="\r" if key == "Enter" and kind == "keyDown" else "")

    def look(self, width, height, dark=False):
        self.call("Emulation.setScrollbarsHidden", hidden=True)
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def picture(self, path):
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        shot = self.call("Page.captureScreenshot", captureBeyondViewport=True,
                         clip={"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1})
        with open(path, "wb") as file:
            file.write(base64.b64decode(shot["data"]))
