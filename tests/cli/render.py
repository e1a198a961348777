#!/usr/bin/env python3
"""`rayuela render` and `info` do what their flags say. Argument: rayuela."""

import json
import os
import pathlib
import signal
import struct
import subprocess
import sys
import time
import zlib

rayuela = sys.argv[1]
scenes = pathlib.Path(os.environ["RAYUELA_ASSETS"]) / "scenes"
# Sanitizers make everything several times slower.
PATIENCE = int(os.environ.get("RAYUELA_PATIENCE", 1))


def run(*arguments):
    done = subprocess.run([rayuela, *map(str, arguments)], capture_output=True, text=True, timeout=100 * PATIENCE)
    assert done.returncode == 0, f"{arguments}: status {done.returncode}\n{done.stderr}"
    return done


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        assert float(file.readline()) < 0, "little endian"
        data = file.read()
    assert len(data) == 12 * width * height
    return width, height, data


def png_size(path):
    data = pathlib.Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", data[16:24])


def test_formats_and_size():
    for name, size in (("a.png", "40x30"), ("a.exr", "40x30"), ("a.pfm", "17x9")):
        run("render", scenes / "cornell.scene.json", "-o", name, "--spp", 1, "--size", size)
        assert pathlib.Path(name).stat().st_size > 100
    assert png_size("a.png") == (40, 30)
    assert read_pfm("a.pfm")[:2] == (17, 9)


def test_stats():
    run("render", scenes / "cornell.scene.json", "-o", "s.pfm", "--spp", 3, "--size", "32x32", "--stats", "stats.json")
    stats = json.loads(pathlib.Path("stats.json").read_text())
    for key in ("load_seconds", "build_seconds", "render_seconds", "cpu_seconds", "spp", "samples_per_second",
                "rays_per_second", "nodes", "leaves", "primitives", "references", "peak_memory_bytes", "rejected_samples"):
        assert key in stats, key
    assert stats["spp"] == 3
    assert stats["rejected_samples"] == 0
    assert stats["references"] >= stats["primitives"] > 0
    assert stats["peak_memory_bytes"] > 1 << 20


def test_same_image_for_any_threads_and_structure():
    base = ["render", scenes / "final.scene.json", "--spp", 2, "--size", "64x36", "--seed", 7, "-o"]
    run(*base, "base.pfm")
    image = read_pfm("base.pfm")[2]
    for flags in (["--threads", 1], ["--threads", 5], ["--kd-leaf-size", 1], ["--kd-leaf-size", 500],
                  ["--kd-split", "median"], ["--accelerator", "list"]):
        run(*base, "other.pfm", *flags)
        assert read_pfm("other.pfm")[2] == image, flags
    run(*base[:-3], "--seed", 8, "-o", "other.pfm")
    assert read_pfm("other.pfm")[2] != image, "another seed is another image"


def test_a_replayed_sample_is_that_of_the_film():
    scene = [scenes / "cornell.scene.json", "--size", "32x24"]
    run("render", *scene, "--spp", 1, "-o", "r.pfm")
    width, height, data = read_pfm("r.pfm")
    lit = 0
    for x, y in ((3, 4), (16, 12), (30, 23)):
        printed = run("render", *scene, "--replay", f"{x},{y},0").stdout
        assert "bounce 0\n" in printed and "  throughput  (1 1 1)\n" in printed
        sample = [float(v) for v in printed.strip().splitlines()[-1].removeprefix("sample (").rstrip(")").split()]
        first = 12 * (width * (height - 1 - y) + x)
        pixel = struct.unpack("<3f", data[first:first + 12])
        assert all(abs(a - b) <= 1e-5 * abs(b) for a, b in zip(sample, pixel)), (x, y, sample, pixel)
        lit += sum(pixel) > 0
    assert lit > 0 and "  error bound (" in run("render", *scene, "--replay", "16,12,0").stdout
    wrong = subprocess.run([rayuela, "render", str(scene[0]), "--replay", "1,99999,0"], capture_output=True, text=True)
    assert wrong.returncode == 1 and "is no sample of a film" in wrong.stderr


def test_bounces():
    def mean(bounces):
        run("render", scenes / "cornell.scene.json", "-o", "b.pfm", "--spp", 4, "--size", "32x32", "--max-bounces", bounces)
        data = read_pfm("b.pfm")[2]
        values = struct.unpack(f"<{len(data) // 4}f", data)
        return sum(values) / len(values)

    none, one, many = mean(0), mean(1), mean(8)
    assert none < one < many


def test_time_limit():
    start = time.monotonic()
    run("render", scenes / "cornell.scene.json", "-o", "t.png", "--time", 1, "--stats", "t.json")
    assert 1 <= time.monotonic() - start < 20
    assert json.loads(pathlib.Path("t.json").read_text())["spp"] >= 1


def test_interrupt_saves():
    process = subprocess.Popen([rayuela, "render", str(scenes / "cornell.scene.json"), "-o", "i.pfm", "--spp", "1000000",
                                "--size", "64x64"], stdout=subprocess.PIPE, text=True)
    time.sleep(3)
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=20 * PATIENCE)
    assert process.returncode == 0 and "interrupted" in output
    assert read_pfm("i.pfm")[:2] == (64, 64)


def test_no_progress_bar_in_a_pipe():
    assert run("render", scenes / "cornell.scene.json", "-o", "q.png", "--spp", 1, "--size", "16x16").stderr == ""


def test_info():
    info = json.loads(run("info", scenes / "fig2.scene.json", "--json").stdout)
    assert info["objects"]["box"] == 1
    assert "box" in run("info", scenes / "fig2.scene.json").stdout
    assert info["meshes"]["count"] == 0

    pathlib.Path("two.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n")
    info = json.loads(run("info", "two.obj", "--json").stdout)
    assert info["meshes"]["triangles"] == 2
    each = info["meshes"]["bytes_a_triangle"]
    trees = each.pop("trees")
    assert each == {"indices": 12, "positions": 24, "normals": 0, "uvs": 0, "uvs_aside": 0}
    assert info["meshes"]["largest"] == {
        "two.obj": {"triangles": 2, "instances": 1, "bytes_a_triangle": {"mesh": 36, "tree": trees}}
    }
    assert trees > 40
    # Three corners and an extent of four bytes each in a leaf, its number, and whatever the nodes and the object take.
    assert info["accelerator"]["bytes_a_primitive"] > 44


def test_adaptive_and_clamp():
    base = ["render", scenes / "cornell.scene.json", "--size", "64x64", "--stats", "adaptive.json", "-o", "adaptive.pfm"]

    def stats(*arguments):
        printed = run(*base, *arguments).stdout
        return json.loads(pathlib.Path("adaptive.json").read_text()), printed

    plain, _ = stats("--spp", 40)
    assert plain["mean_spp"] == 40 and plain["finished_pixels"] == 0 and plain["clamp_removed"] == 0
    adaptive, printed = stats("--adaptive", 0.1)
    assert adaptive["finished_pixels"] == 1 and 32 <= adaptive["mean_spp"] <= adaptive["spp"]
    assert adaptive["estimated_error"] < 1.2 * 0.1**2
    assert f"up to {adaptive['spp']}" in printed
    assert stats("--adaptive", 0.01, "--spp", 33)[0]["spp"] == 33
    clamped, printed = stats("--spp", 40, "--clamp", 0.5)
    assert 0 < clamped["clamp_removed_share"] < 1 and "clamp" in printed
    for wrong in (["--adaptive", 0], ["--adaptive", "x"], ["--clamp", -1], ["--clamp", "nan"]):
        assert subprocess.run([rayuela, *map(str, base + wrong)], capture_output=True).returncode == 2, wrong


def test_skips():
    def skips(scene):
        printed = json.loads(run("info", scenes / f"{scene}.scene.json", "--skips", "--json").stdout)
        assert printed["counted_in_camera_paths"] > 100
        for skip in printed["skips"]:
            assert skip["why"]
            assert not (skip["state"] == "skipped" and skip.get("done", {"amount": 0})["amount"]), (scene, skip)
        return {skip["name"]: skip for skip in printed["skips"]}

    sky, room = skips("weekend"), skips("cornell")
    assert sky["Shadow rays"]["state"] == "skipped" and sky["Environment"]["done"]["amount"] > 0
    assert sky["Lens samples"]["state"] == "needed"
    assert room["Environment"]["state"] == "skipped" and room["Shadow rays"]["done"]["amount"] > 0
    table = run("info", scenes / "cornell.scene.json", "--skips").stdout
    assert len(table.splitlines()) == 2 + len(room)
    assert all(any(line.startswith(name) for line in table.splitlines()) for name in room)


def png(width, height):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = (b"\0" + bytes(3 * width)) * height
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + parts


def test_what_nothing_shows_is_not_in_memory():
    side = 400
    vertices = [(i / side, j / side) for i in range(side + 1) for j in range(side + 1)]
    quads = [i * (side + 1) + j + 1 for i in range(side) for j in range(side)]
    pathlib.Path("land.obj").write_text(
        "".join(f"v {x} 0 {z}\n" for x, z in vertices)
        + "".join(f"vt {x} {z}\n" for x, z in vertices)
        + "".join(f"f {a}/{a} {b}/{b} {c}/{c}\n" for a in quads for b, c in [(a + 1, a + side + 1)])
    )
    pathlib.Path("picture.png").write_bytes(png(300, 200))

    def skips(land, hidden):
        colour = {"texture": "picture.png"}
        scene = {
            "rayuela": 1,
            "materials": {
                "plain": {"type": "diffuse"},
                "picture": {"type": "diffuse", "albedo": colour},
                "spare": {"type": "metal", "albedo": colour},
            },
            "objects": [
                {"type": "mesh", "file": "land.obj", "material": land},
                {"type": "sphere", "material": "picture", "visible": not hidden},
            ],
        }
        pathlib.Path("land.scene.json").write_text(json.dumps(scene))
        printed = json.loads(run("info", "land.scene.json", "--skips", "--json").stdout)["skips"]
        left_out = {skip["name"]: skip.get("left_out", {"amount": 0})["amount"] for skip in printed}
        return left_out["Texture coordinates of vertices"], left_out["Pixels of textures"]

    uvs, pixels = 8 * (side * (side + 1) + side), 16 * 300 * 200
    assert skips("plain", hidden=True) == (uvs, pixels)
    assert skips("plain", hidden=False) == (uvs, 0)
    assert skips("picture", hidden=True) == (0, 0)


tests = [value for name, value in list(globals().items()) if name.startswith("test_")]
failed = 0
for test in tests:
    try:
        test()
    except AssertionError as error:
        failed += 1
        print(f"{test.__name__}: {error}")
print(f"{len(tests) - failed} passed, {failed} failed")
sys.exit(failed > 0)
