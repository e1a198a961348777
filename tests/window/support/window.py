"""A real window under Xvfb, driven by xdotool, for the tests beside this folder.

The screen is read from Xvfb's own memory file (XWD format), so that no program for screenshots is needed.
"""

import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import time
import zlib

SIZE = (1280, 800)
# Sanitizers make everything several times slower.
PATIENCE = int(os.environ.get("RAYUELA_PATIENCE", 1))


class Screen:
    """An X server without a display, whose picture is a file."""

    def __init__(self, folder):
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "%dx%dx24" % SIZE, "-fbdir", str(folder), "-nolisten", "tcp",
             "-noreset"],
            pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        self.number = os.fdopen(read).readline().strip()
        if not self.number:
            sys.exit("Xvfb did not start")
        self.file = folder / "Xvfb_screen0"

    def pixels(self):
        """Rows of RGB bytes."""
        data = self.file.read_bytes()
        header = struct.unpack(">25I", data[:100])
        size, width, height, order, depth, stride, colors = (header[i] for i in (0, 4, 5, 7, 11, 12, 19))
        assert (depth, order) == (32, 0), "unexpected pixel format"
        start = size + 12 * colors
        rows = []
        for y in range(height):
            row = data[start + y * stride:start + y * stride + 4 * width]
            rgb = bytearray(3 * width)
            rgb[0::3], rgb[1::3], rgb[2::3] = row[2::4], row[1::4], row[0::4]
            rows.append(bytes(rgb))
        return rows

    def close(self):
        self.server.terminate()
        self.server.wait(10)


def save_png(name, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    body = zlib.compress(b"".join(b"\0" + row for row in rows), 1)
    header = struct.pack(">2I5B", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)
    pathlib.Path(name).write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b""))


def wait_for(what, condition, seconds=40):
    end = time.monotonic() + seconds * PATIENCE
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.2)
    sys.exit(f"waited in vain for {what}")


class Window:
    """The program, started on a scene (a dictionary) with a configuration folder of its own."""

    def __init__(self, program, scene, screen, folder):
        file = folder / "box.scene.json"
        file.write_text(json.dumps(scene))
        self.config = folder / "config" / "rayuela"
        self.config.mkdir(parents=True, exist_ok=True)
        (self.config / "preferences.json").write_text(json.dumps({"first_start": False, "sampling": {"adaptive": False}}))
        environment = dict(os.environ, DISPLAY=":" + screen.number, XDG_CONFIG_HOME=str(folder / "config"),
                           LIBGL_ALWAYS_SOFTWARE="1")
        self.screen, self.environment = screen, environment
        self.process = subprocess.Popen([program, str(file)], env=environment)
        self.window = wait_for("the window", lambda: self.search("Rayuela"))
        wait_for("the scene", lambda: file.name in self.title())

    def xdotool(self, *words):
        result = subprocess.run(["xdotool", *map(str, words)], env=self.environment, capture_output=True, text=True)
        return result.stdout

    def search(self, name):
        assert self.process.poll() is None, f"the program ended with {self.process.poll()}"
        return self.xdotool("search", "--name", name).split()

    def title(self):
        return self.xdotool("getwindowname", self.window[0]).strip()

    def wait_for_picture(self, name, what, condition):
        """The first picture that fulfils the condition; on a busy machine a frame may take long."""
        seen = []

        def look():
            seen[:] = [self.screen.pixels()]
            return condition(seen[0])

        try:
            wait_for(what, look)
        finally:
            save_png(f"{name}.png", seen[0])
        print(f"ok: {what}")
        return seen[0]

    def press_with_ctrl(self, key):
        # Slowly: on a busy machine a frame may take longer than xdotool holds the keys.
        for words in (["keydown", "ctrl"], ["key", key], ["keyup", "ctrl"]):
            self.xdotool(*words)
            time.sleep(0.5)

    def close(self):
        self.process.terminate()
        self.process.wait(10)

    def drag(self, start, delta, button=1, steps=10):
        self.xdotool("mousemove", *start)
        time.sleep(0.2)
        self.xdotool("mousedown", button)
        for i in range(1, steps + 1):
            self.xdotool("mousemove", start[0] + delta[0] * i // steps, start[1] + delta[1] * i // steps)
            time.sleep(0.03)
        time.sleep(0.2)
        self.xdotool("mouseup", button)
        time.sleep(0.5)


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")
    print(f"ok: {message}")


def run(drive):
    """Calls drive(program, screen, folder); the exit status of the test. 77 (skipped) where Xvfb or xdotool is missing."""
    if not shutil.which("Xvfb") or not shutil.which("xdotool"):
        print("Xvfb or xdotool is not installed")
        return 77
    folder = pathlib.Path.cwd()
    shutil.rmtree(folder / "config", ignore_errors=True)
    screen = Screen(folder)
    try:
        drive(sys.argv[1], screen, folder)
    finally:
        screen.close()
    return 0
