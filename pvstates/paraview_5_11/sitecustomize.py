"""For Debian 12: its ParaView 5.11 imports inspect.getargspec, which its Python 3.11 no longer has; so it can load no
plugin in Python. With this folder on PYTHONPATH it can. ParaView 5.12 and later need nothing."""
import inspect

if not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec
