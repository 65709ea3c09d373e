"""Parameters of algorithms made from the keys of a case, as `frana describe --json` tells them."""
from qgis.core import (
    QgsProcessingParameterBoolean,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterEnum,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
)

_NUMBERS = ("number", "number_or_path", "number_or_choice", "integer")


def help_of(entry):
    """All that the table says of a key, for the side panel and for `qgis_process help`."""
    default = entry.get("default", entry.get("absent", "required" if entry["required"] else "none"))
    text = f"{entry['key']}: {entry['help']}; value: {entry['value']}; default: {default}"
    for other in entry.get("otherwise", []):
        text += f"; {other['default']} with {other['when']} = {other['is']}"
    if entry.get("used_by"):
        text += f"; only with {entry['switch']} = {', '.join(entry['used_by'])}"
    if entry["kind"] == "choice":
        text += "; scripts give the word, not its number"
    if entry.get("instead_of"):
        text += f"; or {entry['instead_of']} in its place"
    return text


def label_of(entry):
    words = entry["help"].split(";")[0].split(":")[0].split(", or ")[0]
    unit = entry["unit"]
    return words[0].upper() + words[1:] + (f" [{unit}]" if unit not in ("", "1") else "")


def _number(name, entry, default):
    kind = QgsProcessingParameterNumber.Integer if entry["kind"] == "integer" else QgsProcessingParameterNumber.Double
    widget = QgsProcessingParameterNumber(name, label_of(entry), kind, default, optional=True)
    limits = entry.get("range", {})
    if "low" in limits:
        widget.setMinimum(limits["low"])  # an open end is left to the program, which says so in a sentence
    if "high" in limits:
        widget.setMaximum(limits["high"])
    return widget


def widget(name, entry, advanced=False, default=None):
    """A parameter for a key. None where a widget makes no sense (files, points, lists): those go by SET."""
    if default is None and not entry.get("otherwise"):  # a default that hangs on another key is the program's to take
        default = entry.get("default")
    if entry["kind"] == "choice":
        made = QgsProcessingParameterEnum(name, label_of(entry), entry["choices"], False, default, True,
                                          usesStaticStrings=True)
    elif entry["kind"] == "flag":
        made = QgsProcessingParameterBoolean(name, label_of(entry), default, True)
    elif entry["kind"] in ("text", "name"):
        made = QgsProcessingParameterString(name, label_of(entry), default, False, True)
    elif entry["kind"] in _NUMBERS:
        made = _number(name, entry, default)
    else:
        return None
    made.setHelp(help_of(entry))
    return set_advanced(made) if advanced else made


def set_advanced(parameter):
    parameter.setFlags(parameter.flags() | QgsProcessingParameterDefinition.FlagAdvanced)
    return parameter
