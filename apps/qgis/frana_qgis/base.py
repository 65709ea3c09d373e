"""What all algorithms share: the program called with progress, cancel, remarks and errors as Processing has them."""
import os
import shlex

from qgis.core import (
    NULL,
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterNumber,
)

from . import program, settings
from .widgets import set_advanced


class FranaAlgorithm(QgsProcessingAlgorithm):
    """
    Subclasses say their name, title and help, and implement work() and, where they have layers, prepare(). Both may raise
    Trouble. prepare() runs in the main thread, to which layers belong; work() in the background.
    """

    NAME = TITLE = HELP = ""

    def createInstance(self):
        return type(self)()

    def name(self):
        return self.NAME

    def displayName(self):
        return self.TITLE

    def shortHelpString(self):
        return self.HELP

    def canExecute(self):
        try:
            settings.frana()
        except program.Trouble as trouble:
            return False, str(trouble)
        return True, ""

    def prepareAlgorithm(self, parameters, context, feedback):
        self._trouble = None
        try:
            settings.frana()  # scripts do not ask canExecute()
            self.prepare(parameters, context, feedback)
        except program.Trouble as trouble:  # told by processAlgorithm(): what is raised here reaches no script
            self._trouble = trouble
        return True

    def processAlgorithm(self, parameters, context, feedback):
        try:
            if self._trouble:
                raise self._trouble
            return self.work(parameters, context, feedback)
        except program.Trouble as trouble:
            raise QgsProcessingException(str(trouble)) from trouble

    def prepare(self, parameters, context, feedback):
        pass

    def work(self, parameters, context, feedback):
        raise NotImplementedError

    # Parameters

    def add_threads(self):
        self.addParameter(set_advanced(QgsProcessingParameterNumber(
            "THREADS", "Threads; empty: as many as the machine has", optional=True, minValue=1, maxValue=4096)))

    def add_flag(self, name, label, default=False):
        self.addParameter(set_advanced(QgsProcessingParameterBoolean(name, label, default)))

    def given(self, parameters, name):
        value = parameters.get(name)
        return value is not None and value != NULL and value != ""

    def threads(self, parameters, context):
        if not self.given(parameters, "THREADS"):
            return []
        return ["--threads", str(self.parameterAsInt(parameters, "THREADS", context))]

    def ticked(self, parameters, context, *names):
        """("RESUME", ...) -> ["--resume", ...] of those that are ticked."""
        return [f"--{name.lower()}" for name in names if self.parameterAsBool(parameters, name, context)]

    # The program

    def call(self, arguments, feedback):
        """Runs `frana ARGUMENTS` to its end. QgsProcessingException with the program's sentence where it failed."""
        path = settings.frana()
        feedback.pushCommandInfo(shlex.join(["frana", *arguments]))

        def tell(event, text):
            if event is None:
                feedback.pushInfo(text)
            elif event["event"] == "progress":
                feedback.setProgress(100.0 * event["share"])
                feedback.setProgressText(progress_text(event))
            elif event["event"] == "pictures":
                feedback.setProgressText(f"{event['done']} of {event['all']} pictures drawn")
            elif event["event"] == "scene":
                feedback.pushInfo(scene_text(event))

        ended = program.call([path, *arguments], tell, feedback.isCanceled)
        for remark in ended.remarks():
            feedback.pushWarning(f"remark: {remark}")
        why = program.sentence(ended)
        if why:
            raise QgsProcessingException(why)
        return ended


def progress_text(event):
    if "runs" in event:
        return f"{event['done']} of {event['runs']} runs, {event['failed']} failed, about {event['eta']:.0f} s left"
    left = "" if event["eta"] is None else f", about {event['eta']:.0f} s left"
    return f"t = {event['time']:.4g} of {event['end']:.4g} s, {event['particles']} particles{left}"


def scene_text(event):
    nodes = " x ".join(str(count) for count in event["nodes"])
    return (f"{event['title']}: {nodes} nodes of {event['cell']:.6g} m, {event['particles']} particles, "
            f"{event['release_volume']:.6g} m3, {event['threads']} threads; into {event['folder']}")


def existing(folder, name):
    """Path of a result, or None where a run left none."""
    path = os.path.join(folder, *name.split("/"))
    return path if os.path.exists(path) else None
