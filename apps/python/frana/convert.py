"""Arrays as objects of other packages. These are imported only when they are asked for."""
import importlib

_DEBIAN = {"xarray": "apt install python3-xarray", "geopandas": "apt install python3-geopandas",
           "shapely": "apt install python3-shapely", "pyvista": "pip install pyvista (Debian 12 has no package of it)"}


def needed(package, asked):
    """The package; ImportError that says what to install."""
    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise ImportError(f"{asked} needs {package}: {_DEBIAN[package]}") from error


def grid_to_xarray(fields, x, y, crs):
    xarray = needed("xarray", "to_xarray()")
    columns = {}
    for name in fields:
        array = fields[name].copy()
        if name == "arrival_time":
            array[array < 0.0] = float("nan")  # frames have -1 where the flow never came
        dims = ("y", "x") if array.ndim == 2 else ("y", "x", f"component_of_{array.shape[2]}")
        columns[name] = (dims, array, {"units": fields.unit(name)})
    return xarray.Dataset(columns, coords={"y": ("y", y, {"units": "m"}), "x": ("x", x, {"units": "m"})},
                          attrs={"crs_wkt": crs})


def _structured(pyvista, x, y, z):
    import numpy

    east, north = numpy.meshgrid(x, y)
    return pyvista.StructuredGrid(east, north, z)


def _at_points(array):
    """(ny, nx, ...) in the order of a structured grid's points, which runs along y first: a row for each point."""
    return array.swapaxes(0, 1).reshape(-1, *array.shape[2:])


def grid_to_pyvista(fields, x, y):
    mesh = _structured(needed("pyvista", "to_pyvista()"), x, y, fields["elevation"].copy())
    for name in fields:
        mesh.point_data[name] = _at_points(fields[name])
    return mesh


def raster_to_pyvista(raster, x, y):
    import numpy

    mesh = _structured(needed("pyvista", "to_pyvista()"), x, y, numpy.zeros(raster.array.shape))
    mesh.point_data[raster.name or "values"] = _at_points(raster.array)
    return mesh


def particles_to_pyvista(fields):
    mesh = needed("pyvista", "to_pyvista()").PolyData(fields["position"].copy())
    for name in fields:
        if name != "position":
            mesh.point_data[name] = fields[name].copy()
    return mesh


def particles_to_geodataframe(fields, crs):
    geopandas = needed("geopandas", "to_geodataframe()")
    columns = {}
    for name in fields:
        array = fields[name]
        if array.ndim == 1:
            columns[name] = array.copy()
        else:
            for k in range(array.shape[1]):
                columns[f"{name}_{'xyz'[k] if array.shape[1] <= 3 else k}"] = array[:, k].copy()
    position = fields["position"]
    return geopandas.GeoDataFrame(columns, geometry=geopandas.points_from_xy(position[:, 0], position[:, 1]),
                                  crs=crs or None)


def raster_to_geodataframe(raster, above):
    import numpy

    geopandas = needed("geopandas", "to_geodataframe()")
    box = needed("shapely", "to_geodataframe()").geometry.box
    chosen = ~numpy.isnan(raster.array) if above is None else raster.array > above
    west, north, cell = raster.transform.c, raster.transform.f, raster.cell
    squares = [box(west + column * cell, north - (row + 1) * cell, west + (column + 1) * cell, north - row * cell)
               for row, column in numpy.argwhere(chosen)]
    return geopandas.GeoDataFrame({raster.name or "value": raster.array[chosen]}, geometry=squares, crs=raster.crs or None)
