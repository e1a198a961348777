#!/usr/bin/env python3
"""Checks who may include whom (the rules are the tables below). Usage: check_includes.py [REPOSITORY]"""

import pathlib
import re
import sys

# A layer of core may include itself and these.
LAYERS = {
    "math": [],
    "shapes": ["math"],
    "accel": ["math", "shapes"],
    "materials": ["math", "shapes"],
    "scene": ["math", "shapes", "accel", "materials"],
    "lights": ["math", "shapes", "accel", "materials", "scene"],
    "io": ["math", "shapes", "accel", "materials", "scene"],
    "render": ["math", "shapes", "accel", "materials", "scene", "lights"],
}

# A library's headers, and the only folders or files that may include them.
LIBRARIES = {
    r"(GL|GLES\d?|EGL|KHR|GLFW|glad)/": ["ui", "tests/ui"],
    r"(imgui|implot|ImGuizmo|imgui_te_|imgui_test_engine/)": ["ui", "tests/ui", "cmake"],
    r"(tiny_gltf|tiny_obj|stb|OpenEXR/|Imf|Imath)": ["core/io", "tests"],
    r"nlohmann/": ["core/io", "ui", "app", "tests"],
    r"CLI/": ["app", "assets"],
    # What starts parallel work; the others set its limits.
    r"tbb/(parallel|task_group|flow_graph|blocked_range|partitioner)": ["core/accel/parallel.h"],
    r"tbb/|oneapi/": ["core/accel", "core/render", "core/io", "app", "tests", "assets"],
    r"hwy/": ["core/math", "core/accel", "core/lights", "core/render", "tests"],
    r"embree\d/": ["app", "tests"],
}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
FOLDERS = ["core", "ui", "app", "tests", "assets", "cmake"]


def problem(path, header):
    """Why a file (its path from the root) may not include a header, or None."""
    top = path.split("/")[0]
    if header.startswith("app/") and top != "app" and not path.startswith("tests/unit/app/"):
        return "only app and tests/unit/app/ include app"
    if header.startswith("ui/") and top not in ("ui", "app") and not path.startswith("tests/ui/"):
        return "only ui, app and tests/ui include ui"
    if header.startswith("tests/") and top != "tests":
        return "only tests include tests"
    if header.startswith("core/"):
        layer = header.split("/")[1]
        if layer not in LAYERS:
            return f"core/{layer} is no layer; name it in {pathlib.Path(__file__).name} and CMakeLists.txt"
        if top == "core":
            own = path.split("/")[1]
            if layer != own and layer not in LAYERS.get(own, []):
                return f"core/{own} may include only {', '.join(LAYERS.get(own, [])) or 'itself'}"
    for pattern, folders in LIBRARIES.items():
        if re.match(pattern, header) and not any(f"{path}/".startswith(f"{folder}/") for folder in folders):
            return f"only {', '.join(folders)} include this library"
    return None


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    count, found = 0, 0
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in (".h", ".hpp", ".cpp", ".inl"):
                continue
            count += 1
            path = file.relative_to(root).as_posix()
            text = file.read_text(encoding="utf-8")
            for match in INCLUDE.finditer(text):
                why = problem(path, match[1])
                if why:
                    found += 1
                    line = text.count("\n", 0, match.start(1)) + 1
                    print(f'{path}:{line}: includes "{match[1]}": {why}')
    print(f"{count} files, {found} forbidden includes")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
