"""Makes the .pvsm templates in this folder from the readable states beside them, in ParaView itself.

    pvbatch make_states.py RUN_DIR [STATE...] [--out FOLDER]

RUN_DIR is a run that has everything (stress, a profile, a survey; for the state impact, 3D points and a
barrier; for structure, a case with [material.structure]; for phases, one with [water]; for probability, the folder of
an ensemble); which one does not matter, for all that belongs to the run becomes a slot: `frana run` and `frana states` put
there what src/run/folder/states.h says. To know what belongs to the run, each number and text of its look is replaced by
one of a kind before the state is built, and searched for in what ParaView saved. Domains, informative properties, property ids and values that equal their defaults are left out:
a state then is a tenth of its size, loads the same, and changes line by line.
"""
import argparse
import importlib
import json
import os
import shutil
import sys
import tempfile
import xml.etree.ElementTree as tree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from paraview import servermanager, simple  # noqa: E402

from frana_scene import NoState  # noqa: E402

STATES = ["overview", "stress", "profiles", "survey", "impact", "structure", "phases", "budgets", "probability"]
FILES = ["FileName", "FileNames"]
WHOLE = {"VOI": "/cross/extent/%d", "SampleRateI": "/cross/stride", "SampleRateJ": "/cross/stride",
         "LegendLocation": "/legend", "EndTime": "/last_time"}  # what cannot be marked: whole numbers, the data's times
OF_SOME = {  # fixed in other states
    "LegendLocation": ["profiles"], "EndTime": ["overview", "stress", "profiles", "impact"]}
NEEDLESS = {  # names of arrays that ParaView picks by itself, and what belongs to a user's own settings
    "PointArrayStatus", "CellArrayStatus", "SelectionPointFieldDataArrayName", "SelectionCellFieldDataArrayName",
    "SetScaleArray", "OpacityArray", "OpacityArrayName", "OSPRayScaleArray", "GlyphTableIndexArray", "SelectScaleArray",
    "SelectNormalArray", "SelectTangentArray", "SelectTCoordArray", "Camera2DManipulators", "Camera3DManipulators",
    "TimestepValues"}


def marked(look):
    """The look with every number made one of a kind, less than 1e-4 of itself nearer to 0 (times stay within the run),
    and its slots: [(value, pointer)]."""
    slots = []

    def walk(value, pointer):
        if isinstance(value, dict):
            return {key: walk(part, pointer + "/" + key) for key, part in value.items()}
        if isinstance(value, list):
            return [walk(part, "%s/%d" % (pointer, k)) for k, part in enumerate(value)]
        if isinstance(value, float) and value not in (0.0, 1.0, -1.0):
            value = value * (1.0 - 1e-6 * (7.0 + 0.731 * len(slots)))
        if pointer.startswith("/bar/"):
            value += " " * (len(slots) % 16 + 1)  # an axis may have the same title, and another bar
        if not isinstance(value, int) and value not in (0.0, 1.0, -1.0, "") and not pointer.startswith("/states"):
            slots.append((value, pointer))
        return value

    return walk(look, ""), slots


def same(text, value):
    if isinstance(value, str):
        return text == value
    try:
        return abs(float(text) - value) <= 1e-9 * abs(value)
    except ValueError:
        return False


def slot_of(text, slots):
    found = [pointer for value, pointer in slots if same(text, value)]
    return found[0] if found else None


def set_slots(state, proxy_property, slots, look, run_dir):
    """Marks the elements of a property that belong to the run."""
    elements = proxy_property.findall("Element")
    name = proxy_property.get("name")
    values = [element.get("value") for element in elements]
    if name in FILES:
        for element in elements:
            file = os.path.relpath(element.get("value"), run_dir)
            set_value(element, file, "file:" + file)
        return
    if name in ("RGBPoints", "Points") and len(values) >= 8:
        set_range(elements, values, look)
        return
    if name in WHOLE and state in OF_SOME.get(name, STATES):
        for k, element in enumerate(elements):
            set_value(element, element.get("value"), WHOLE[name] % k if "%" in WHOLE[name] else WHOLE[name])
        return
    for element in elements:
        slot = slot_of(element.get("value"), slots)
        if slot:
            set_value(element, element.get("value"), slot)


def set_range(elements, values, look):
    """Control points of a colour map as parts of the range they span."""
    low, high = float(values[0]), float(values[-4])
    for name, limits in look["range"].items():
        if all(abs(a - b) <= 1e-9 * max(map(abs, limits)) for a, b in zip((low, high), limits)):
            for element, text in list(zip(elements, values))[::4]:
                set_value(element, text, "/range/%s@%.10g" % (name, (float(text) - low) / (high - low)))


def set_value(element, value, slot):
    index = element.attrib.pop("index", None)
    element.attrib.clear()
    if index is not None:
        element.set("index", index)
    element.set("value", value)
    element.set("slot", slot)


def is_default(proxy, name):
    found = proxy.GetProperty(name) if proxy else None
    return bool(found) and name != "Time" and bool(found.IsValueDefault())


def prune(root):
    """Leaves out what ParaView makes by itself when it loads the state."""
    session = servermanager.ActiveConnection.Session
    for proxy in root.findall(".//Proxy[@id]"):
        live = session.GetRemoteObject(int(proxy.get("id")))
        for one in list(proxy.findall("Property")):
            if one.get("name").endswith("Info") or one.get("name") in NEEDLESS or is_default(live, one.get("name")):
                proxy.remove(one)
                continue
            one.attrib.pop("id", None)
            for domain in one.findall("Domain"):
                one.remove(domain)


def save(name, run_dir, look, slots, folder):
    simple.ResetSession()
    servermanager.ActiveConnection.Session.GetSessionProxyManager().UnRegisterAllLinks()  # a reset keeps them
    simple._DisableFirstRenderCameraReset()
    module = importlib.import_module(name)
    module.build(run_dir)
    for layout in simple.GetLayouts().values():
        layout.SetSize(*module.SIZE)
    simple.RenderAllViews()
    raw = os.path.join(folder, name + ".raw")
    servermanager.SaveState(raw)
    root = tree.parse(raw).getroot()
    os.remove(raw)
    prune(root)
    for settings in root.findall(".//Settings/.."):
        settings.remove(settings.find("Settings"))
    for one in root.iter("Property"):
        set_slots(name, one, slots, look, run_dir)
    tree.indent(root, " ")
    file = os.path.join(folder, name + ".pvsm")
    with open(file, "w") as stream:
        stream.write(tree.tostring(root, encoding="unicode") + "\n")
    print("%s: %d kB, %d slots" % (file, os.path.getsize(file) // 1000,
                                   sum(1 for element in root.iter("Element") if element.get("slot"))))


def main():
    parser = argparse.ArgumentParser(description="Makes the templates of frana's ParaView states.")
    parser.add_argument("run_dir")
    parser.add_argument("states", nargs="*", help="the states to make; default: all that the run has")
    parser.add_argument("--out", default=os.path.dirname(os.path.abspath(__file__)))
    given = parser.parse_args()
    os.makedirs(given.out, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        # A stand-in for the run with a look of its own; everything else is linked.
        for entry in os.listdir(given.run_dir):
            if entry != "states":
                os.symlink(os.path.abspath(os.path.join(given.run_dir, entry)), os.path.join(folder, entry))
        os.mkdir(os.path.join(folder, "states"))
        with open(os.path.join(given.run_dir, "states", "look.json")) as stream:
            look, slots = marked(json.load(stream))
        with open(os.path.join(folder, "states", "look.json"), "w") as stream:
            json.dump(look, stream)
        for name in given.states or [name for name in STATES if not look["states"][name]]:
            save(name, folder, look, slots, given.out)


if __name__ == "__main__":
    try:
        main()
        status = 0
    except NoState as problem:
        print(problem, file=sys.stderr)
        status = 2
    sys.stdout.flush()
    os._exit(status)  # pvbatch's own way out loses the status
