#!/usr/bin/env python3
"""Checks the includes between folders: python3 folders_test.py SOURCE_DIR

Every folder with C++ sources has a README.md whose paragraph "May include: ..." lists the folders whose headers it may
include. Included are no others, what is listed is used, and neither folders nor files include each other in a circle;
a header and the source file of the same name count as one file."""
import os
import re
import sys

MODULES = ["meshes/scene", "fast", "reference", "compare"]
INCLUDE = re.compile(r'\s*#\s*include\s+"([^"]+)"')


def sources(root):
    for module in MODULES:
        for folder, _, names in sorted(os.walk(os.path.join(root, module))):
            for name in sorted(names):
                if name.endswith((".h", ".cc")):
                    yield os.path.relpath(os.path.join(folder, name), root)


def included(root, path):
    """The project's own headers that a file includes, as paths from the root."""
    with open(os.path.join(root, path), encoding="utf-8") as lines:
        for line in lines:
            match = INCLUDE.match(line)
            if match:
                name = match[1]
                yield "meshes/" + name if name.startswith("scene/") else name


def allowed(root, folder):
    """What the folder's README lets it include; nothing where there is no such paragraph."""
    try:
        with open(os.path.join(root, folder, "README.md"), encoding="utf-8") as file:
            match = re.search(r"May include: (.*?)\.\n\n", file.read(), re.DOTALL)
    except FileNotFoundError:
        return None
    return set(re.findall(r"`([^`]+)`", match[1])) if match else None


def circles(graph):
    """The strongly connected parts of more than one node (R. Tarjan, SIAM J. Comput. 1 (1972) 146-160)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(graph.get(node, ())):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            part = []
            while not part or part[-1] != node:
                part.append(stack.pop())
            if len(part) > 1:
                found.append(sorted(part))

    sys.setrecursionlimit(10000)
    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def faults(root):
    folders, files = {}, {}
    for path in sources(root):
        folder = os.path.dirname(path)
        folders.setdefault(folder, {})
        of_file = files.setdefault(os.path.splitext(path)[0], set())
        for other in included(root, path):
            stem = os.path.splitext(other)[0]
            if stem != os.path.splitext(path)[0]:
                of_file.add(stem)
            if os.path.dirname(other) != folder:
                folders[folder].setdefault(os.path.dirname(other), []).append(f"{path} includes {other}")
    if not folders:
        yield f"no source found under {root}, so nothing was checked"
    for folder, uses in sorted(folders.items()):
        may = allowed(root, folder)
        if may is None:
            yield f'{folder}: no README.md with a paragraph "May include: ..."'
            continue
        for other in sorted(set(uses) - may):
            yield f"{folder} may not include {other}: " + "; ".join(uses[other])
        for other in sorted(may - set(uses)):
            yield f"{folder}/README.md lists {other}, which nothing there includes"
    for circle in circles(folders):
        yield "folders include each other in a circle: " + ", ".join(circle)
    for circle in circles(files):
        yield "files include each other in a circle: " + ", ".join(circle)


def main():
    wrong = list(faults(sys.argv[1]))
    for fault in wrong:
        print(fault)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
