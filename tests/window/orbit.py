#!/usr/bin/env python3
"""Opens the real window under Xvfb, drives it with xdotool and looks at the screen. Usage: orbit.py PROGRAM

The screen is read from Xvfb's own memory file (XWD format), so that no program for screenshots is needed. Pictures of
each step are left as PNG files in the current folder. Exits with 77 (skipped) where Xvfb or xdotool is missing.
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

SCENE = {
    "rayuela": 1,
    "camera": {"position": [0, 1.2, 5], "target": [0, 0.8, 0], "vfov": 40},
    "environment": {"type": "gradient"},
    "materials": {"red": {"type": "diffuse", "albedo": [0.8, 0.1, 0.1]}},
    "objects": [
        {"type": "plane", "name": "Floor"},
        {"type": "box", "name": "Box", "min": [-0.8, 0, -0.8], "max": [0.8, 1.6, 0.8], "material": "red"},
    ],
}
SIZE = (1280, 800)
# A point of the image, beside its middle, where the box is seen.
MIDDLE = (620, 330)


class Screen:
    """An X server without a display, whose picture is a file."""

    def __init__(self, folder):
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "%dx%dx24" % SIZE, "-fbdir", str(folder), "-nolisten", "tcp"],
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


def image_part(rows):
    """The middle of the viewport, away from panels and text."""
    return [row[3 * 420:3 * 820] for row in rows[180:480]]


def difference(a, b):
    """Mean difference of the bytes."""
    a, b = b"".join(a), b"".join(b)
    return sum(abs(x - y) for x, y in zip(a[::7], b[::7])) / len(a[::7])


def wait_for(what, condition, seconds=40):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.2)
    sys.exit(f"waited in vain for {what}")


class Window:
    def __init__(self, program, scene, screen, folder):
        environment = dict(os.environ, DISPLAY=":" + screen.number, XDG_CONFIG_HOME=str(folder / "config"),
                           LIBGL_ALWAYS_SOFTWARE="1")
        self.screen, self.environment = screen, environment
        self.process = subprocess.Popen([program, str(scene)], env=environment)
        self.window = wait_for("the window", lambda: self.search("Rayuela"))

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


def drive(program, screen, folder):
    scene = folder / "box.scene.json"
    scene.write_text(json.dumps(SCENE))
    config = folder / "config" / "rayuela"
    config.mkdir(parents=True, exist_ok=True)
    (config / "preferences.json").write_text(json.dumps({"first_start": False}))
    window = Window(program, scene, screen, folder)

    def red(rows):
        part = image_part(rows)
        return sum(row[i] > row[i + 1] + 60 for row in part for i in range(0, len(row), 30)) > 100

    def outline(rows):
        # Pixels of the accent colour.
        part = image_part(rows)
        return sum(row[i] > 225 and 140 < row[i + 1] < 200 and row[i + 2] < 110
                   for row in part for i in range(0, len(row), 3)) > 200

    wait_for("the scene", lambda: "box.scene.json" in window.title())
    window.wait_for_picture("1-opened", "the red box is seen", red)
    time.sleep(3)
    first = image_part(screen.pixels())

    window.drag(MIDDLE, (160, 40))
    window.wait_for_picture("2-turned", "dragging turns the view", lambda rows: difference(first, image_part(rows)) > 5)
    wait_for("the mark of a change in the title", lambda: "*" in window.title())

    window.press_with_ctrl("z")
    window.wait_for_picture("3-undone", "undo brings the view back", lambda rows: difference(first, image_part(rows)) < 4)
    wait_for("the title without the mark", lambda: "*" not in window.title())

    window.xdotool("mousemove", *MIDDLE, "click", 1)
    window.wait_for_picture("4-selected", "a click outlines the box", outline)

    window.xdotool("windowsize", window.window[0], 1000, 700)
    window.wait_for_picture("5-resized", "a smaller window shows the whole interface",
                            lambda rows: max(rows[350][3 * 1010:]) == 0 and len(set(rows[350][3 * 900:3 * 1000])) > 3)

    window.press_with_ctrl("q")
    wait_for("the end of the program", lambda: window.process.poll() is not None)
    check(window.process.returncode == 0, "Ctrl+Q ends the program")
    check((config / "layout.ini").exists(), "the layout is remembered")


def main():
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


if __name__ == "__main__":
    sys.exit(main())
