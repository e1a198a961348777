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
    (TRACER, "const bool materials_vary = scene_.features().textures || !options_.shortcuts.ready_materials;",
     "constexpr bool materials_vary = false;"),
    (TRACER, "return kVaries && (material.textured || !options_.shortcuts.ready_materials);",
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
source = folder / "whole" / "source"


def copy_sources():
    for part in ("app", "assets", "cmake", "core", "shaders", "ui"):
        shutil.copytree(root / part, source / part, dirs_exist_ok=True)
    shutil.copy2(root / "CMakeLists.txt", source)
    # Not downloaded again.
    deps = root / "build" / "deps"
    if deps.exists() and not (source / "build" / "deps").exists():
        (source / "build").mkdir()
        (source / "build" / "deps").symlink_to(deps)


def build(name, replacements):
    """The program with each old replaced by the new if `replacements`, else as it is. Copies it to `name`."""
    texts = {file: (root / file).read_text() for file, _, _ in WITHOUT}
    for file, old, new in replacements:
        assert texts[file].count(old) == 1, f"{file}: '{old}' is there {texts[file].count(old)} times"
        texts[file] = texts[file].replace(old, new)
    for file, text in texts.items():
        (source / file).write_text(text)
    with open(folder / f"{name}.log", "w") as log:
        for command in (["cmake", "-S", source, "-B", folder / "whole" / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                         "-DCMAKE_CXX_FLAGS_RELEASE=-O3 -DNDEBUG -Wno-error", "-DBUILD_TESTING=OFF"],
                        ["cmake", "--build", folder / "whole" / "build", "--target", "rayuela"]):
            if subprocess.run(command, stdout=log, stderr=log).returncode:
                sys.exit(f"the build failed: {log.name}")
    return shutil.copy2(folder / "whole" / "build" / "rayuela", folder / name)


def seconds(program, image):
    stats = folder / "stats.json"
    subprocess.run([program, "render", root / SCENE, "-o", image, "--spp", str(SAMPLES), "--threads", "1", "--stats", stats],
                   check=True, capture_output=True)
    return json.loads(stats.read_text())["cpu_seconds"]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 21
    source.mkdir(parents=True, exist_ok=True)
    copy_sources()
    with_all, without = build("with_all", []), build("without", WITHOUT)
    images = folder / "with_all.pfm", folder / "without.pfm"
    ratios = [seconds(with_all, images[0]) / seconds(without, images[1]) for _ in range(rounds)]
    assert images[0].read_bytes() == images[1].read_bytes(), "the images differ"
    generator = random.Random(60)
    medians = sorted(statistics.median(generator.choices(ratios, k=rounds)) for _ in range(2000))
    median = statistics.median(ratios)
    print(f"{median:.4f} times the time of the stripped build, 95% interval {medians[50]:.4f} to {medians[1949]:.4f}, "
          f"{rounds} rounds; required <= {LIMIT}")
    sys.exit(median > LIMIT)


main()
