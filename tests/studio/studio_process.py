"""A studio that runs: its address, its requests, its end."""

import http.client
import json
import os
import re
import signal
import subprocess
import tempfile

failures = []


def check(holds, what):
    print(("ok      " if holds else "FAILED  ") + what, flush=True)
    if not holds:
        failures.append(what)


class Studio:
    def __init__(self, program, state=None, *words):
        self.folder = tempfile.TemporaryDirectory() if state is None else None
        self.state = state or self.folder.name
        env = {**os.environ, "XDG_STATE_HOME": self.state, "XDG_CACHE_HOME": self.state}
        self.process = subprocess.Popen([program, "studio", "--no-open", "--quiet", *words],
                                        stdout=subprocess.PIPE, text=True, env=env)
        self.address = self.process.stdout.readline().strip()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=([0-9a-f]{32})", self.address)
        if not found:
            raise SystemExit(f"no address: {self.address!r}")
        self.port, self.token = int(found.group(1)), found.group(2)

    def ask(self, method, path, body=None, headers=None, token=True, timeout=120):
        """Status, headers, bytes."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        sent = {"Content-Type": "application/json", **(headers or {})}
        if token:
            sent.setdefault("X-Studio-Token", self.token)
        try:
            connection.request(method, path, body, sent)
            reply = connection.getresponse()
            return reply.status, reply.headers, reply.read()
        finally:
            connection.close()

    def post(self, path, asked):
        status, _, body = self.ask("POST", path, json.dumps(asked))
        return status, json.loads(body)

    def end(self, by=signal.SIGINT):
        self.process.send_signal(by)
        return self.process.wait(timeout=20)
