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
    assert {build["structure"] for build in mesh["builds"]} - {"Embree robust"} == ours
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


def test_a_file_is_a_mesh():
    pathlib.Path("tent.obj").write_text("v -1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    run("bench", "rays", "tent.obj", "--side", 32, "--repetitions", 1, "--json", "file.json")
    (mesh,) = json.loads(pathlib.Path("file.json").read_text())
    assert mesh["mesh"] == "tent.obj" and mesh["triangles"] == 2, mesh
    assert any(entry["rays"] == "primary" for entry in mesh["speeds"]), mesh
    pathlib.Path("ball.json").write_text('{"objects": [{"shape": {"type": "sphere"}}]}')
    run("bench", "rays", "ball.json", status=1)


def test_threads_scale():
    run("bench", "rays", "box70k", "--side", 64, "--repetitions", 2, "--builds", 2, "--threads", "1,2", "--json",
        "threads.json")
    (mesh,) = json.loads(pathlib.Path("threads.json").read_text())
    ours = [figure for figure in mesh["scaling"] if figure["who"] == "kd"]
    assert {figure["what"] for figure in ours} == KINDS | {"build"}, ours
    assert [figure["threads"] for figure in ours] == [1, 2] * 6, ours
    for figure in ours:
        low, high = figure["interval"]
        assert 0 < low <= figure["speed_up"] <= high, figure
        assert figure["threads"] > 1 or figure["speed_up"] == 1, figure


def test_sizes_cost():
    run("bench", "rays", "--side", 32, "--repetitions", 2, "--sizes", "1k,20k", "--json", "sizes.json")
    figures = json.loads(pathlib.Path("sizes.json").read_text())
    assert {figure["rays"] for figure in figures} == KINDS, figures
    sizes = [figure["triangles"] for figure in figures if figure["rays"] == "primary"]
    assert 950 < sizes[0] < 1050 and 19_500 < sizes[1] < 20_500, sizes
    assert all(figure["nanoseconds"]["kd"] > 0 for figure in figures), figures


def test_leaf_sizes_step():
    run("bench", "rays", "box70k", "--median", "--builds", 2, "--leaf-steps", "8,16,64", "--json", "steps.json")
    (mesh,) = json.loads(pathlib.Path("steps.json").read_text())
    steps = [(figure["from"], figure["to"]) for figure in mesh["leaf_steps"]]
    assert steps == [(8, 16), (16, 64), (64, 16), (16, 8)] * 2, steps
    for figure in mesh["leaf_steps"]:
        low, high = figure["share_interval"]
        assert 0 < low <= figure["cpu_share"] <= high, figure
        assert figure["from"] > figure["to"] or figure["cpu_share"] < 1, figure


def test_wrong_use_is_named():
    assert "2000M" in run("bench", "rays", "--sizes", "1k,2000M", status=2).stderr
    assert "--threads" in run("bench", "rays", "--threads", "0", status=2).stderr
    assert "nosuch" in run("bench", "rays", "nosuch", status=2).stderr
    assert "--repetitions" in run("bench", "rays", "--repetitions", "0", status=2).stderr
    assert "folder" in run("bench", "rays", "box70k", "--side", 16, "--repetitions", 1, "--json", "no/folder.json",
                           status=1).stderr


test_all_contestants_agree_and_are_reported()
test_a_file_is_a_mesh()
test_threads_scale()
test_sizes_cost()
test_leaf_sizes_step()
test_wrong_use_is_named()
