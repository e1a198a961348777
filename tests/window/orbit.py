#!/usr/bin/env python3
"""Opens the real window under Xvfb, drives it with xdotool and looks at the screen. Usage: orbit.py PROGRAM

Pictures of each step are left as PNG files in the current folder.
"""

import sys
import time

from support.window import PATIENCE, Window, check, run, wait_for

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
# A point of the image, beside its middle, where the box is seen.
MIDDLE = (620, 330)


def image_part(rows):
    """The middle of the viewport, away from panels and text."""
    return [row[3 * 420:3 * 820] for row in rows[180:480]]


def difference(a, b):
    """Mean difference of the bytes."""
    a, b = b"".join(a), b"".join(b)
    return sum(abs(x - y) for x, y in zip(a[::7], b[::7])) / len(a[::7])


def drive(program, screen, folder):
    window = Window(program, SCENE, screen, folder)

    def red(rows):
        part = image_part(rows)
        return sum(row[i] > row[i + 1] + 60 for row in part for i in range(0, len(row), 30)) > 100

    def outline(rows):
        # Pixels of the accent colour.
        part = image_part(rows)
        return sum(row[i] > 225 and 140 < row[i + 1] < 200 and row[i + 2] < 110
                   for row in part for i in range(0, len(row), 3)) > 200

    window.wait_for_picture("1-opened", "the red box is seen", red)
    # What noise is left then stays below what turning the view changes.
    time.sleep(3 * PATIENCE)
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
    check((window.config / "layout.ini").exists(), "the layout is remembered")


if __name__ == "__main__":
    sys.exit(run(drive))
