"""Where the program is: an entry of Settings > Options > Processing > Providers."""
from processing.core.ProcessingConfig import ProcessingConfig, Setting

from . import program

_PATH = "FRANA_PROGRAM"


def add(group):
    ProcessingConfig.addSetting(
        Setting(group, _PATH, "Program frana (empty: where it is found by itself)", "", valuetype=Setting.FILE)
    )
    ProcessingConfig.readSettings()


def remove():
    ProcessingConfig.removeSetting(_PATH)


def frana():
    """The program; program.Trouble when there is none, or one that is too old."""
    return program.ready(ProcessingConfig.getSetting(_PATH) or "")
