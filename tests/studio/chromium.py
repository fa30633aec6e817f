"""Headless Chromium by its debugging pipe: mouse, keyboard, pictures; and what the program itself says."""

import base64
import csv
import json
import os
import subprocess
import tempfile
import time

from studio_process import check


class Browser:
    """The DevTools protocol over pipes: JSON, each message ended by a zero."""

    def __init__(self, chromium, size, pictures=None):
        """pictures: the folder (pathlib.Path) of screenshots; None: none are taken."""
        self.pictures = pictures
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_read, self.to = os.pipe()
        self.come_from, from_write = os.pipe()

        def pipes():
            os.dup2(to_read, 3)
            os.dup2(from_write, 4)

        # Both ends are moved above 4 first: dup2 of one would close the other.
        to_read, from_write = (os.dup(os.dup(os.dup(fd))) if fd < 10 else fd for fd in (to_read, from_write))
        self.process = subprocess.Popen(
            [chromium, "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             f"--user-data-dir={self.profile.name}", f"--window-size={size}", "--remote-debugging-pipe", "about:blank"],
            preexec_fn=pipes, close_fds=False, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(from_write)
        self.buffer, self.number, self.session, self.problems = b"", 0, None, []
        pages = [t for t in self.send("Target.getTargets")["targetInfos"] if t["type"] == "page"]
        target = pages[0]["targetId"]
        self.session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Accessibility"):
            self.send(f"{domain}.enable")
        self.send("Emulation.setFocusEmulationEnabled", enabled=True)

    def send(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            while b"\0" not in self.buffer:
                got = os.read(self.come_from, 1 << 20)
                if not got:
                    raise SystemExit("the browser has ended")
                self.buffer += got
            text, self.buffer = self.buffer.split(b"\0", 1)
            reply = json.loads(text)
            if reply.get("method") == "Runtime.exceptionThrown":
                self.problems.append(reply["params"]["exceptionDetails"].get("exception", {}).get("description", "?"))
            if reply.get("id") == self.number:
                if "error" in reply:
                    raise SystemExit(f"{method}: {reply['error']}")
                return reply["result"]

    def run(self, script):
        result = self.send("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise SystemExit(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.run(f"Boolean({condition})"):
                return True
            time.sleep(0.02)
        check(False, f"{what}: not within {seconds} s ({self.run('document.body.innerText.slice(0, 300)')!r})")
        return False

    def open(self, address):
        self.send("Page.navigate", url=address)
        self.wait("document.body && document.body.dataset.ready", "the page stands")

    def key(self, key, code=0, modifiers=0):
        text = {"Enter": "\r", " ": " "}.get(key, "")
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key, windowsVirtualKeyCode=code, modifiers=modifiers, text=text)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key, windowsVirtualKeyCode=code, modifiers=modifiers)

    def tab_to(self, selector):
        """By the tabulator alone, as somebody without a mouse."""
        for _ in range(120):
            self.key("Tab", 9)
            if self.run(f"document.activeElement.matches({json.dumps(selector)})"):
                return True
        check(False, f"the tabulator reaches {selector}")
        return False

    def replace_text(self, text):
        self.key("a", 65, 2)
        self.run("document.activeElement.select?.()")
        self.send("Input.insertText", text=text)
        self.key("Enter", 13)

    def click(self, selector):
        x, y = self.run(f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView({{block: 'center'}}); "
                        "const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()")
        for kind in ("mousePressed", "mouseReleased"):
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def type(self, selector, text):
        self.click(selector)
        self.run("document.activeElement.select()")
        self.send("Input.insertText", text=text)
        self.key("Enter", 13)
        self.run("document.activeElement.blur()")

    def size(self, width, height, scheme="light"):
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def picture(self, name):
        if self.pictures:
            time.sleep(0.3)
            self.pictures.mkdir(exist_ok=True)
            (self.pictures / f"{name}.png").write_bytes(base64.b64decode(self.send("Page.captureScreenshot")["data"]))

    def close(self):
        self.process.kill()
        self.process.wait()


def solved(browser, what, does):
    """Runs `does` and waits for the real solution that follows."""
    before = browser.run("Number(document.body.dataset.solved || 0)")
    does()
    return browser.wait(f"Number(document.body.dataset.solved || 0) > {before} && !document.body.classList.contains('preview') "
                        "&& document.getElementById('studio-status').textContent.startsWith('solved')", what)


def table(program, *words):
    """Rows of the CSV that the program prints."""
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    return list(csv.DictReader(line for line in done.stdout.splitlines() if not line.startswith("#")))
