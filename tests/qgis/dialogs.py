"""The plugin's dialogs in QGIS's own window: each is opened and photographed, that of a run is filled in and started by its button.

Called inside of QGIS (qgis --code) by tests/qgis_dialogs.sh, which gives FRANA_SOURCE, FRANA_WORK and FRANA_PROGRAM in the
environment. Writes FRANA_WORK/said.json: what went wrong, by dialog; empty when all is well.
"""
import json
import os
import shutil
import time
import traceback

import processing
from qgis.core import QgsApplication, QgsProject
from qgis.PyQt.QtCore import QTimer
from qgis.PyQt.QtWidgets import QApplication, QWidget
from qgis.utils import iface, loadPlugin, startPlugin

SOURCE, WORK = os.environ["FRANA_SOURCE"], os.environ["FRANA_WORK"]
ALGORITHMS = ("check", "run", "runcase", "compare", "ensemble", "calibrate")
said = {}


def wait(until, seconds):
    """Lets the window work until that holds; False when it never does."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        QApplication.processEvents()
        if until():
            return True
        time.sleep(0.02)
    return False


def photograph(widget, name):
    wait(lambda: False, 0.3)
    widget.grab().save(os.path.join(WORK, name + ".png"))


def open_dialog(name, parameters):
    dialog = processing.createAlgorithmDialog("frana:" + name, parameters)
    if dialog is None:
        raise RuntimeError("no dialog")
    dialog.show()
    return dialog


def look_at(name):
    dialog = open_dialog(name, {})
    photograph(dialog, name)
    algorithm = QgsApplication.processingRegistry().algorithmById("frana:" + name)
    shown = {label for label in (getattr(w, "text", lambda: "")() for w in dialog.findChildren(QWidget)) if isinstance(label, str)}
    missing = [p.description() for p in algorithm.parameterDefinitions()
               if not p.isDestination() and not any(p.description() in label for label in shown)]
    if missing:
        said[name] = f"not shown: {missing}"
    dialog.close()


def run():
    """Filled in, started by the button, its layers in the project, its log on the second page."""
    case = os.path.join(SOURCE, "cases", "maungawhau")
    out = os.path.join(WORK, "run")
    dialog = open_dialog("runcase", {"CASE": os.path.join(case, "case.toml"), "OUTPUT": out})
    photograph(dialog, "filled")
    dialog.runButton().click()
    if not wait(lambda: os.path.exists(os.path.join(out, "run.json")) and dialog.runButton().isEnabled(), 300):
        said["run"] = ["did not end"]
    wait(lambda: len(QgsProject.instance().mapLayers()) > 0, 30)
    photograph(dialog, "ran")
    log = dialog.findChild(QWidget, "txtLog")
    text = log.toPlainText() if log is not None else ""
    with open(os.path.join(WORK, "log.txt"), "w", encoding="utf-8") as file:
        file.write(text)
    if "report.md" not in text and "t = " not in text:
        said.setdefault("run", []).append("no progress in the log")
    if not QgsProject.instance().mapLayers():
        said.setdefault("run", []).append("no layer in the project")
    dialog.close()
    iface.mapCanvas().zoomToFullExtent()
    wait(lambda: not iface.mapCanvas().isDrawing(), 30)
    photograph(iface.mainWindow(), "window")


def all_of_it():
    try:
        loadPlugin("frana_qgis")
        startPlugin("frana_qgis")
        for name in ALGORITHMS:
            look_at(name)
        run()
    except Exception:  # pylint: disable=broad-except
        said["error"] = traceback.format_exc()
    with open(os.path.join(WORK, "said.part"), "w", encoding="utf-8") as file:
        json.dump(said, file)
    shutil.move(os.path.join(WORK, "said.part"), os.path.join(WORK, "said.json"))
    os._exit(0)  # QGIS would ask whether to save the project


QTimer.singleShot(2000, all_of_it)
