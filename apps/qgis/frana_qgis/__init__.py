"""Landslides of the program frana in QGIS' Processing toolbox."""


def classFactory(iface):  # the name that QGIS calls
    from .plugin import FranaPlugin

    return FranaPlugin()
