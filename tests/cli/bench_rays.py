#!/usr/bin/env python3
"""`rayuela bench rays` finds no disagreement and reports every contestant on every kind of rays. Argument: rayuela."""

import json
import pathlib
import subprocess
import sys

rayuela = sys.argv[1]
KINDS = {"primary", "bounce", "bounce, shuffled", "shadow", "shadow from bounce"}


def run(*arguments, status=0):
    done = subprocess.run([rayuela, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == status, f"{arguments}: status {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def test_all_contestants_agree_and_are_reported():
    done = run("bench", "rays", "box70k", "--side", 32, "--repetitions", 2, "--leaf-size", "8,16", "--median", "--list",
               "--json", "rays.json")
    (mesh,) = json.loads(pathlib.Path("rays.json").read_text())
    assert mesh["mesh"] == "box70k" and 69_000 < mesh["triangles"] < 71_000, mesh
    ours = {"kd sah 8", "kd sah 16", "kd median 8", "kd median 16"}
    assert {build["structure"] for build in mesh["builds"]} == ours
    who = {entry["who"] for entry in mesh["speeds"]}
    assert ours | {"list"} <= who, who
    for name in who:
        assert {entry["rays"] for entry in mesh["speeds"] if entry["who"] == name} == KINDS, name
        assert name in done.stdout
    for entry in mesh["speeds"]:
        low, high = entry["interval"]
        assert 0 < low <= entry["mrays_per_second"] <= high, entry
        if entry["who"] in ours and "Embree single robust" in who:
            assert entry["differs_ppm"] <= 2e6 / 32**2, entry


def test_wrong_use_is_named():
    assert "nosuch" in run("bench", "rays", "nosuch", status=2).stderr
    assert "--repetitions" in run("bench", "rays", "--repetitions", "0", status=2).stderr
    assert "folder" in run("bench", "rays", "box70k", "--side", 16, "--repetitions", 1, "--json", "no/folder.json",
                           status=1).stderr


test_all_contestants_agree_and_are_reported()
test_wrong_use_is_named()
