#!/usr/bin/env python3
"""`rayuela bench skips` and `info --measure` say what is saved, of what a scene can do without. Argument: rayuela."""

import json
import pathlib
import subprocess
import sys
import tempfile

rayuela = sys.argv[1]
SCENE = {"rayuela": 1, "film": {"width": 32, "height": 24},
         "materials": {"grey": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]},
                       "lamp": {"type": "emitter", "radiance": [4, 4, 4]}},
         "objects": [{"type": "sphere", "material": "grey"},
                     {"type": "sphere", "center": [0, 4, 0], "radius": 0.5, "material": "lamp"}],
         "environment": None}


def run(*arguments):
    done = subprocess.run([rayuela, *map(str, arguments)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout


with tempfile.TemporaryDirectory() as folder:
    scene = pathlib.Path(folder) / "ball.scene.json"
    scene.write_text(json.dumps(SCENE))
    figures = pathlib.Path(folder) / "gains.json"
    text = run("bench", "skips", scene, "--side", 16, "--spp", 1, "--repetitions", 3, "--json", figures)
    (measured,) = json.loads(figures.read_text())
    assert measured["scene"] == "ball", measured
    gains = {gain["shortcut"]: gain for gain in measured["gains"]}
    for gain in gains.values():
        low, high = gain["interval"]
        assert 0 < low <= gain["ratio"] <= high, gain
        assert gain["name"] in text, gain
    assert {"no_sky", "any_hit", "few_objects", "lobe_blocks"} <= set(gains), gains
    assert "no_light" not in gains, "there is a lamp"

    skips = json.loads(run("info", scene, "--measure", "--json"))["skips"]
    timed = {skip["name"] for skip in skips if "time_with_it" in skip}
    assert timed == {gain["name"] for gain in gains.values()}, timed
    assert all(skip["state"] == "skipped" for skip in skips if skip["name"] in timed), skips
