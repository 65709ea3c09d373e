"""What a run is made from, set beside what an earlier run in the folder was made from until it is known to be right. Knows
nothing of QGIS."""
import os
import shutil
import tempfile

from .program import Trouble


class Inputs:
    """The folder `input` of a run's folder. Files are written into `path`, and lie where place() says after accept()."""

    def __init__(self, folder):
        self.final = os.path.join(folder, "input")
        try:
            os.makedirs(folder, exist_ok=True)
            self.path = tempfile.mkdtemp(prefix=".input_", dir=folder)
            os.chmod(self.path, 0o755)
        except OSError as error:
            raise Trouble(f"OUTPUT: found {folder}, where nothing can be written ({error.strerror}); expected a folder of "
                          "yours; choose another one") from error

    def replaces(self):
        """Whether an earlier run's would go."""
        return os.path.isdir(self.final)

    def place(self, file):
        """Where a file will lie; those that are elsewhere stay there."""
        inside = os.path.relpath(file, self.path)
        return file if inside.startswith(os.pardir) or os.path.isabs(inside) else os.path.join(self.final, inside)

    def accept(self):
        old = self.path + "_old"
        if self.replaces():
            os.rename(self.final, old)
        os.rename(self.path, self.final)
        shutil.rmtree(old, ignore_errors=True)

    def drop(self):
        """Unless they were accepted they go, and those of the earlier run stay."""
        shutil.rmtree(self.path, ignore_errors=True)
