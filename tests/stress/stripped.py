#!/usr/bin/env python3
"""Catalogue 60: a scene that lacks a feature takes at most 1.02 times the time of a build from which the feature is taken out.

Builds the program twice below build/stripped, as it is and without lenses, textures, skies, planes and paths from lamps, and
renders the example "cornell", which has none of these, with both in turn. Usage: tests/stress/stripped.py [ROUNDS]
"""

import json
import pathlib
import random
import shutil
import statistics
import subprocess
import sys

LIMIT = 1.02
SCENE = "assets/scenes/cornell.scene.json"
SAMPLES = 16
TRACER, MATTE, KERNELS = "core/render/path_tracer.cpp", "core/render/path_tracer_matte.cpp", "core/accel/kd_kernels.cpp"
WITHOUT = [
    (TRACER, "const bool lens_extends = scene_.features().lens || !options_.shortcuts.no_lens;",
     "constexpr bool lens_extends = false;"),
    (TRACER, "return material.textured || !options_.shortcuts.ready_materials;",
     "static_cast<void>(material);\n    return false;"),
    (TRACER, "if (!scene_.features().environment && options_.shortcuts.no_sky) continue;", "if (true) continue;"),
    (TRACER, "return light_tracer_ && light_tracer_->lamps_are_small() && bounce > 0 && state.light_ratio == 0;",
     "static_cast<void>(state), static_cast<void>(bounce);\n    return false;"),
    (TRACER, "light_tracer_ ? light_tracer_->camera_weight(state.light_ratio, hit, at) : 1;", "1;"),
    (TRACER, "if (light_tracer_) state.light_ratio", "if (false) state.light_ratio"),
    (MATTE, "if (light_tracer_) {", "if (false) {"),
    ("core/render/interaction.h", "varying_(varies ?", "varying_(varies && false ?"),
    (KERNELS, "for (const std::uint32_t index : scene.planes) {", "for (const std::uint32_t index : {0u}) {\n        break;"),
]

root = pathlib.Path(__file__).resolve().parents[2]
folder = root / "build" / "stripped"


def build(name, replacements):
    source, binary = folder / name / "source", folder / name / "build"
    # Copied over what is there, so that only what differs is compiled again.
    for part in ("app", "assets", "cmake", "core", "shaders", "ui", "CMakeLists.txt"):
        if (root / part).is_dir():
            shutil.copytree(root / part, source / part, dirs_exist_ok=True)
        else:
            shutil.copy2(root / part, source / part)
    for file, old, new in replacements:
        text = (source / file).read_text()
        assert text.count(old) == 1, f"{file}: '{old}' is there {text.count(old)} times"
        (source / file).write_text(text.replace(old, new))
    deps = root / "build" / "deps"
    if deps.exists() and not (source / "build" / "deps").exists():
        (source / "build").mkdir(exist_ok=True)
        (source / "build" / "deps").symlink_to(deps)
    with open(folder / f"{name}.log", "w") as log:
        for command in (["cmake", "-S", source, "-B", binary, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                         "-DCMAKE_CXX_FLAGS_RELEASE=-O3 -DNDEBUG -Wno-error", "-DBUILD_TESTING=OFF"],
                        ["cmake", "--build", binary, "--target", "rayuela"]):
            if subprocess.run(command, stdout=log, stderr=log).returncode:
                sys.exit(f"the build failed: {log.name}")
    return binary / "rayuela"


def seconds(program, image):
    stats = folder / "stats.json"
    subprocess.run([program, "render", root / SCENE, "-o", image, "--spp", str(SAMPLES), "--threads", "1", "--stats", stats],
                   check=True, capture_output=True)
    return json.loads(stats.read_text())["cpu_seconds"]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 21
    folder.mkdir(parents=True, exist_ok=True)
    whole, stripped = build("whole", []), build("without", WITHOUT)
    images = folder / "whole.pfm", folder / "without.pfm"
    ratios = [seconds(whole, images[0]) / seconds(stripped, images[1]) for _ in range(rounds)]
    assert images[0].read_bytes() == images[1].read_bytes(), "the images differ"
    generator = random.Random(60)
    medians = sorted(statistics.median(generator.choices(ratios, k=rounds)) for _ in range(2000))
    median = statistics.median(ratios)
    print(f"{median:.4f} times the time of the stripped build, 95% interval {medians[50]:.4f} to {medians[1949]:.4f}, "
          f"{rounds} rounds; required <= {LIMIT}")
    sys.exit(median > LIMIT)


main()
