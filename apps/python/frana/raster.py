"""Rasters as they are given out and taken in: north row first, with transform and CRS."""
from collections import namedtuple

from . import _frana, convert
from .errors import DataError


class Affine(namedtuple("Affine", "a b c d e f")):
    """x = a column + b row + c, y = d column + e row + f of a pixel's upper left corner [m], as rasterio has it.

    Stands in where the package `affine` is not installed.
    """

    def __mul__(self, place):
        column, row = place
        return self.a * column + self.b * row + self.c, self.d * column + self.e * row + self.f

    def to_gdal(self):
        """The same in GDAL's order (c, a, b, f, d, e)."""
        return self.c, self.a, self.b, self.f, self.d, self.e


def _affine(*numbers):
    try:
        from affine import Affine as Known
    except ImportError:
        Known = Affine
    return Known(*numbers)


class Raster:
    """Numbers on square pixels of a map.

    Parameters
    ----------
    array : array_like, shape (rows, columns)
        North row first; NaN, and what a numpy.ma array masks: no data. Numbers of any type, copied to float64.
    transform : six numbers
        As `Affine`: square pixels, north up.
    crs : str or CRS
        WKT, or what has to_wkt(), as CRS of rasterio and pyproj; empty or None: unknown.
    unit, name, description : str
        "m", "peak_depth", "largest depth ever".
    """

    def __init__(self, array, transform, crs="", unit="", name="", description=""):
        import numpy

        mask = numpy.ma.getmaskarray(array) if numpy.ma.isMaskedArray(array) else None
        numbers = numpy.asarray(array)
        if numbers.dtype.kind not in "biuf":
            raise DataError([f"array: found numbers of type {numbers.dtype}; expected real ones; give array.astype(float)"])
        if numbers.ndim != 2 or numbers.size == 0:
            raise DataError([f"array: found the shape {numbers.shape}; expected (rows, columns); give one band"])
        a, b, c, d, e, f = tuple(transform)[:6]
        if not (a > 0 and e == -a and b == 0 and d == 0):
            raise DataError([f"transform: found {tuple(transform)[:6]}; expected (cell, 0, west, 0, -cell, north); "
                             "gdalwarp makes a raster north up with square pixels"])
        self.array = numpy.array(numbers, dtype=float, order="C")
        if mask is not None:
            self.array[mask] = numpy.nan
        self.transform = _affine(a, b, c, d, e, f)
        self.crs = str(crs.to_wkt() if hasattr(crs, "to_wkt") else crs or "")
        self.unit, self.name, self.description = unit, name, description

    @classmethod
    def _of(cls, name, unit, description, north_up):
        array, west, north, cell, crs = north_up
        raster = cls.__new__(cls)
        raster.array, raster.transform = array, _affine(cell, 0.0, west, 0.0, -cell, north)
        raster.crs, raster.unit, raster.name, raster.description = crs, unit, name, description
        return raster

    @property
    def cell(self):
        """Edge of a pixel [m]."""
        return self.transform.a

    @property
    def bounds(self):
        """(xmin, ymin, xmax, ymax) of the pixels' outer edges [m]."""
        rows, columns = self.array.shape
        west, north = self.transform.c, self.transform.f
        return west, north - rows * self.cell, west + columns * self.cell, north

    @property
    def profile(self):
        """What ``rasterio.open(path, "w", **profile)`` asks for."""
        rows, columns = self.array.shape
        return {"driver": "GTiff", "dtype": str(self.array.dtype), "nodata": float("nan"), "width": columns,
                "height": rows, "count": 1, "crs": self.crs or None, "transform": self.transform}

    def __array__(self, dtype=None):
        return self.array if dtype is None else self.array.astype(dtype)

    def at(self, x, y):
        """The number of the pixel that holds the place (x, y) [m]; NaN beyond the raster."""
        import math

        column = math.floor((x - self.transform.c) / self.cell)
        row = math.floor((self.transform.f - y) / self.cell)
        rows, columns = self.array.shape
        return float(self.array[row, column]) if 0 <= row < rows and 0 <= column < columns else math.nan

    def save(self, path):
        """Writes a GeoTIFF of float32. DataError for infinite numbers, and when the disk refuses."""
        import numpy

        if numpy.isinf(self.array).any():
            raise DataError([f"{path}: found infinite numbers; expected finite ones, or NaN for no data"])
        _frana.save_raster(str(path), self.array, self.transform.c, self.transform.f, self.cell, self.crs, self.unit,
                           self.description)

    def _centres(self):
        """Map x of the columns and y of the rows, the northernmost first [m]."""
        rows, columns = self.array.shape
        x = [self.transform.c + (column + 0.5) * self.cell for column in range(columns)]
        return x, [self.transform.f - (row + 0.5) * self.cell for row in range(rows)]

    def to_pyvista(self):
        """A flat pyvista.StructuredGrid with the numbers at the pixels' centres. ImportError without pyvista."""
        return convert.raster_to_pyvista(self, *self._centres())

    def to_geodataframe(self, above=None):
        """A geopandas.GeoDataFrame of pixels with data, a square each. ImportError without geopandas.

        Parameters
        ----------
        above : float, optional
            Only pixels with more than this [unit].
        """
        return convert.raster_to_geodataframe(self, above)

    def to_xarray(self):
        """An xarray.DataArray with the pixels' centres as x and y [m]. ImportError without xarray."""
        xarray = convert.needed("xarray", "to_xarray()")
        x, y = self._centres()
        about = {"units": self.unit, "long_name": self.description, "crs_wkt": self.crs}
        return xarray.DataArray(self.array.copy(), coords={"y": y, "x": x}, dims=("y", "x"), name=self.name, attrs=about)

    def __repr__(self):
        rows, columns = self.array.shape
        return f"<frana.Raster {self.name} {rows} x {columns} of {self.cell:g} m, {self.unit}>"


class Rasters(dict):
    """Rasters by name, also as attributes: ``rasters.peak_depth``."""

    def __getattr__(self, name):
        if name in self:
            return self[name]
        raise AttributeError(f"no raster {name}; there are {', '.join(self)}")


def of_list(rasters):
    return Rasters((name, Raster._of(name, unit, description, north_up)) for name, unit, description, north_up in rasters)
