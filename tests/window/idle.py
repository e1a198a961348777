#!/usr/bin/env python3
"""The window costs nothing while there is nothing to show: finished, paused or minimised. Usage: idle.py PROGRAM"""

import ctypes
import os
import sys
import time

from support.window import Window, check, run, wait_for

SCENE = {
    "rayuela": 1,
    "camera": {"position": [0, 1.2, 5], "target": [0, 0.8, 0], "vfov": 40},
    "environment": {"type": "gradient"},
    "objects": [{"type": "plane", "name": "Floor"}, {"type": "sphere", "name": "Ball", "center": [0, 1, 0], "radius": 1}],
}
MOST_CORES = 0.01


def cpu_seconds(pid):
    """Of all threads, user and system."""
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def cores_used(window, seconds=4):
    start, before = time.monotonic(), cpu_seconds(window.process.pid)
    time.sleep(seconds)
    return (cpu_seconds(window.process.pid) - before) / (time.monotonic() - start)


def check_rest(window, state):
    wait_for(f"rest once {state}", lambda: cores_used(window, 1) < MOST_CORES)
    used = cores_used(window)
    check(used < MOST_CORES, f"{state}, it uses {used:.4f} cores")


def set_minimised(window, minimised):
    """As a window manager does it; Xvfb has none."""
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(window.environment["DISPLAY"].encode()))
    state = ctypes.c_ulong(x11.XInternAtom(display, b"WM_STATE", 0))
    normal_state, iconic_state, replace = 1, 3, 0
    values = (ctypes.c_long * 2)(iconic_state if minimised else normal_state, 0)
    x11.XChangeProperty(display, ctypes.c_ulong(int(window.window[0])), state, state, 32, replace, values, 2)
    x11.XCloseDisplay(display)


def changes(screen, seconds):
    before = screen.pixels()
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        time.sleep(0.2)
        if screen.pixels() != before:
            return True
    return False


def drive(program, screen, folder):
    window = Window(program, dict(SCENE, render={"max_samples": 4}), screen, folder)
    check_rest(window, "finished")
    window.close()

    window = Window(program, SCENE, screen, folder)
    check(changes(screen, 10), "the picture changes while samples are added")
    set_minimised(window, True)
    time.sleep(1)
    check(not changes(screen, 3), "minimised, the window draws nothing")
    check(cores_used(window, 2) > 0.05, "minimised, it goes on rendering")
    set_minimised(window, False)
    check(changes(screen, 10), "restored, it draws again")

    window.xdotool("key", "--window", window.window[0], "p")
    check_rest(window, "paused")
    set_minimised(window, True)
    check_rest(window, "paused and minimised")
    window.close()


if __name__ == "__main__":
    sys.exit(run(drive))
