"""What a run is made from, set beside what an earlier run in the folder was made from until it is known to be right. Knows
nothing of QGIS."""
import os
import re
import shutil
import tempfile

from .program import Trouble


_ABANDONED = re.compile(r"\.input_[a-z0-9_]{8}")
_OF_DATABASES_AND_RASTERS = ("-wal", "-shm", "-journal", ".aux.xml", ".ovr")


class Inputs:
    """
    The folder `input` of a run's folder. Files are written into `path`, and lie where place() says after accept(). Others in
    `input` stay: a person may have given one of them for the new run.
    """

    def __init__(self, folder):
        self.final = os.path.join(folder, "input")
        try:
            os.makedirs(folder, exist_ok=True)
            for name in filter(_ABANDONED.fullmatch, os.listdir(folder)):  # of a call that ended between prepare and work
                shutil.rmtree(os.path.join(folder, name), ignore_errors=True)
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
        """File by file, the case last: `input` is never gone."""
        try:
            if not self.replaces():
                os.rename(self.path, self.final)
                return
            names = sorted(os.listdir(self.path), key=lambda name: (name == "case.toml", name))
            for name in names:
                self._remove_companions(name, names)
                os.replace(os.path.join(self.path, name), os.path.join(self.final, name))
        except OSError as error:
            raise Trouble(f"OUTPUT: the inputs cannot be put into {self.final} ({error.strerror}); expected a folder where "
                          "files can be replaced; choose another one") from error

    def _remove_companions(self, name, names):
        """What belonged to the file that is replaced, and would be taken for a part of the new one."""
        for ending in _OF_DATABASES_AND_RASTERS:
            companion = os.path.join(self.final, name + ending)
            if name + ending not in names and os.path.exists(companion):
                os.remove(companion)

    def drop(self):
        """Unless they were accepted they go, and those of the earlier run stay."""
        shutil.rmtree(self.path, ignore_errors=True)
