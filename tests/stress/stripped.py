#!/usr/bin/env python3
"""What parts of the program cost: builds it twice below build/stripped, as it is and without them, and renders with both in turn.

features: without lenses, textures, skies, planes and paths from lamps. The example "cornell" has none of these and takes at
    most 1.02 times the time of the stripped build, for the same image (catalogue 60).
pads: without the pads of planes, the slack of filters and the care with cancellation that keep the kd-tree watertight, as
    Embree without its robust flag: over the examples they cost at most 3%. Decisions stay in double.

Usage: tests/stress/stripped.py features|pads [ROUNDS]
       tests/stress/stripped.py check     only whether what is to be taken out is there
"""

import json
import math
import pathlib
import random
import shutil
import statistics
import subprocess
import sys

TRACER, LOBES, KERNELS = "core/render/path_tracer.cpp", "core/render/path_tracer_lobes.cpp", "core/accel/kd_kernels.cpp"
FEATURES = [
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
    (TRACER, "if (light_tracer_) next.light_ratio", "if (false) next.light_ratio"),
    (LOBES, "if (light_tracer_) {", "if (false) {"),
    ("core/render/interaction.h", "varying_(varies ?", "varying_(varies && false ?"),
    (KERNELS, "for (const std::uint32_t index : scene.planes) {", "for (const std::uint32_t index : {0u}) {\n        break;"),
]
LANES, PACKETS, TRIANGLES = "core/accel/kd_lanes-inl.h", "core/accel/kd_packets-inl.h", "core/accel/triangle_tests-inl.h"
FEW, SPHERES = "core/accel/few_objects-inl.h", "core/accel/sphere_tests-inl.h"
PADS = [
    (LANES, "pad_[axis][lane] = block.pad[i] * std::fabs(block.inverse[axis][i]);", ""),
    (LANES, "inverse = choice.of(inverse_), pad = choice.of(pad_),", "inverse = choice.of(inverse_),"),
    (LANES, "enter = hn::MulSub(distance, inverse, pad), leave = hn::MulAdd(distance, inverse, pad);",
     "enter = hn::Mul(distance, inverse), leave = enter;"),
    (LANES, "const Floats pad = AxisChoice(hn::And(entry.low, hn::Set(dw, 3))).of(pad_);", ""),
    (LANES, "hn::NegMulAdd(pad, hn::Set(d, 2.25f), end)", "end"),
    (PACKETS, "enter = middle - overlap, leave = middle + overlap;", "enter = middle, leave = middle;\n(void)overlap;"),
    (TRIANGLES, "const Floats slack = hn::MulAdd(ray.slack.slope, triangle.extent, ray.slack.offset);",
     "const Floats slack = hn::Zero(FloatTag());"),
    (TRIANGLES, "z_begin -= depth_pad + kRounding * std::fabs(z_begin);", "(void)depth_pad, (void)kRounding;"),
    (TRIANGLES, "z_end += depth_pad + kRounding * std::fabs(z_end);", ""),
    (TRIANGLES, "if (HWY_LIKELY(hn::AllTrue(dd, hn::And(plain(u, cx_by), hn::And(plain(v, ax_cy), plain(w, bx_ay))))))",
     "(void)dd, (void)plain;\n    if (true)"),
    (FEW, "begin - (least + rounding * hn::Abs(begin)),", "begin,"),
    (FEW, "end + (least + rounding * hn::Abs(end))};", "((void)least, (void)rounding, end)};"),
    (FEW, "hn::Min(lo, hi) - overlap[axis]", "hn::Min(lo, hi)"),
    (FEW, "hn::Max(lo, hi) + overlap[axis]", "hn::Max(lo, hi)"),
    (SPHERES, "const Floats reach = sphere.radius + hn::Set(d, 8) * ray.pad;", "const Floats reach = sphere.radius;"),
]
# What is taken out, scenes and samples to time, the limit of the geometric mean, and whether images stay the same.
PARTS = {
    "features": (FEATURES, {"cornell": 16}, 1.02, True),
    "pads": (PADS, {"cornell": 8, "weekend": 8, "veach": 8, "many_lights": 2, "final": 4, "materials": 8}, 1.03, False),
}

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


def replaced(replacements):
    """The text of each file that may change, with each old replaced by the new."""
    texts = {file: (root / file).read_text() for file, _, _ in FEATURES + PADS}
    for file, old, new in replacements:
        if texts[file].count(old) != 1:
            sys.exit(f"{file}: '{old}' is there {texts[file].count(old)} times; mend {__file__}")
        texts[file] = texts[file].replace(old, new)
    return texts


def build(name, replacements):
    """The program with each old replaced by the new if `replacements`, else as it is. Copies it to `name`."""
    for file, text in replaced(replacements).items():
        (source / file).write_text(text)
    with open(folder / f"{name}.log", "w") as log:
        for command in (["cmake", "-S", source, "-B", folder / "whole" / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                         "-DCMAKE_CXX_FLAGS_RELEASE=-O3 -DNDEBUG -Wno-error", "-DBUILD_TESTING=OFF"],
                        ["cmake", "--build", folder / "whole" / "build", "--target", "rayuela"]):
            if subprocess.run(command, stdout=log, stderr=log).returncode:
                sys.exit(f"the build failed: {log.name}")
    return shutil.copy2(folder / "whole" / "build" / "rayuela", folder / name)


def seconds(program, scene, samples):
    stats = folder / "stats.json"
    subprocess.run([program, "render", root / f"assets/scenes/{scene}.scene.json", "-o", f"{program}.pfm", "--spp", str(samples),
                    "--threads", "1", "--stats", stats], check=True, capture_output=True)
    return json.loads(stats.read_text())["cpu_seconds"]


def interval(ratios):
    generator = random.Random(60)
    medians = sorted(statistics.median(generator.choices(ratios, k=len(ratios))) for _ in range(2000))
    return f"{statistics.median(ratios):.4f}, 95% interval {medians[50]:.4f} to {medians[1949]:.4f}"


def main():
    if sys.argv[1:] == ["check"]:
        for replacements, *_ in PARTS.values():
            replaced(replacements)
        return
    if len(sys.argv) < 2 or sys.argv[1] not in PARTS:
        sys.exit(__doc__)
    replacements, scenes, limit, same = PARTS[sys.argv[1]]
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 21
    source.mkdir(parents=True, exist_ok=True)
    copy_sources()
    with_all, without = build("with_all", []), build("without", replacements)
    medians = []
    for scene, samples in scenes.items():
        ratios = [seconds(with_all, scene, samples) / seconds(without, scene, samples) for _ in range(rounds)]
        if same:
            images = (pathlib.Path(f"{program}.pfm").read_bytes() for program in (with_all, without))
            assert len(set(images)) == 1, "the images differ"
        print(f"{scene}: {interval(ratios)}, {rounds} rounds", flush=True)
        medians.append(statistics.median(ratios))
    mean = math.exp(statistics.fmean(map(math.log, medians)))
    print(f"{mean:.4f} times the time of the stripped build; required <= {limit}")
    sys.exit(mean > limit)


main()
