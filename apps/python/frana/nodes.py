"""What frames of a run and those read back share: where nodes and particles are, and copies for other packages."""
from . import convert


class Nodes:
    """Places of a grid's nodes. The class that takes it has ``_geometry()`` and ``_crs``."""

    @property
    def x(self):
        """Map x of the nodes, shape (nx,) [m]."""
        import numpy

        nx, _, x0, _, cell = self._geometry()
        return x0 + cell * numpy.arange(nx)

    @property
    def y(self):
        """Map y of the nodes, shape (ny,), growing to the north [m]."""
        import numpy

        _, ny, _, y0, cell = self._geometry()
        return y0 + cell * numpy.arange(ny)

    @property
    def cell(self):
        """Distance of the nodes [m]."""
        return self._geometry()[4]

    @property
    def crs(self):
        """WKT; empty: unknown."""
        return self._crs

    def to_xarray(self):
        """An xarray.Dataset of copies, with x and y of the nodes and units; y grows. ImportError without xarray.

        "arrival_time" is NaN where the flow never came; frames have -1 there.
        """
        return convert.grid_to_xarray(self, self.x, self.y, self._crs)

    def to_pyvista(self):
        """A pyvista.StructuredGrid on the ground, fields at its points. ImportError without pyvista."""
        return convert.grid_to_pyvista(self, self.x, self.y)


class Points:
    """Copies of particles. The class that takes it has ``_crs``."""

    @property
    def crs(self):
        """WKT; empty: unknown."""
        return self._crs

    def to_pyvista(self):
        """A pyvista.PolyData of points with their fields. ImportError without pyvista."""
        return convert.particles_to_pyvista(self)

    def to_geodataframe(self):
        """A geopandas.GeoDataFrame of points on the map, a column for each number. ImportError without geopandas."""
        return convert.particles_to_geodataframe(self, self._crs)
