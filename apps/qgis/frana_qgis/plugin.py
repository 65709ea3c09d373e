from qgis.core import QgsApplication

from .provider import FranaProvider


class FranaPlugin:
    def __init__(self):
        self._provider = None

    def initProcessing(self):  # all that qgis_process calls
        self._provider = FranaProvider()
        QgsApplication.processingRegistry().addProvider(self._provider)

    def initGui(self):
        self.initProcessing()

    def unload(self):
        if self._provider:
            QgsApplication.processingRegistry().removeProvider(self._provider)
            self._provider = None
