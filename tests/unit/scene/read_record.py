"""Reads the record that other_programs_test.cpp writes with h5py and meshio and compares every number.

Usage: read_record.py FOLDER. Ends with an exception at the first difference.
"""

import json
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import meshio
import numpy as np

CLOUD = [[0, 0, 0], [1, 0, 0], [0, 2, 0]]
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
# time, XDMF name of the cells, positions, cells, fields
SNAPSHOTS = [
    (0.0, "Polyvertex", CLOUD, [[0], [1], [2]],
     {"pressure": [1, 2, 4], "velocity": [[1, 2, 0], [3, 4, 0], [5, 6, 0]]}),
    (0.5, "Quadrilateral", SQUARE, [[0, 1, 2, 3]], {"pressure": [1, 2, 3, 4]}),
    (1.0, "Triangle", SQUARE, [[0, 1, 2], [0, 2, 3]], {"pressure": [1, 2, 3, 4]}),
]


def check_hdf5(folder):
    with h5py.File(folder / "record.h5", "r") as record:
        tip = record["series/tip"]
        assert list(tip.attrs["columns"]) == ["time", "displacement_x"]
        assert list(tip.attrs["units"]) == ["s", "m"]
        np.testing.assert_array_equal(tip[:], [[0, 0], [0.5, 0.25], [1, 1]])
        profile = record["tables/profile/000000"]
        assert profile.attrs["time"] == 0.5
        assert list(profile.attrs["columns"]) == ["x", "velocity_x"]
        np.testing.assert_array_equal(profile[:], [[0, 1], [2, 3], [4, 5]])
        assert len(record["fields"]) == len(SNAPSHOTS)
        for number, (time, _, positions, cells, fields) in enumerate(SNAPSHOTS):
            snapshot = record[f"fields/{number:06d}"]
            assert snapshot.attrs["time"] == time
            np.testing.assert_array_equal(snapshot["positions"][:], positions)
            np.testing.assert_array_equal(snapshot["cells"][:], cells)
            assert set(snapshot["fields"]) == set(fields)
            for name, values in fields.items():
                np.testing.assert_array_equal(snapshot["fields"][name][:], values)


def check_vtk(folder):
    """VTK's own reader, as ParaView uses it."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    for number, (_, _, positions, cells, fields) in enumerate(SNAPSHOTS):
        reader = vtkHDFReader()
        file = str(folder / f"fields/{number:06d}.vtkhdf")
        assert reader.CanReadFile(file)
        reader.SetFileName(file)
        reader.Update()
        grid = reader.GetOutput()
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetPoints().GetData()), positions)
        assert grid.GetNumberOfCells() == len(cells)
        for c, nodes in enumerate(cells):
            ids = grid.GetCell(c).GetPointIds()
            assert [ids.GetId(k) for k in range(ids.GetNumberOfIds())] == list(nodes)
        for name, values in fields.items():
            np.testing.assert_array_equal(
                vtk_to_numpy(grid.GetPointData().GetArray(name)), values)


def read_item(folder, item):
    """The array that a DataItem names, which must have the shape that it states."""
    file, path = item.text.strip().split(":")
    with h5py.File(folder / file, "r") as data:
        values = data[path][:]
    assert values.shape == tuple(int(n) for n in item.get("Dimensions").split()), item.text
    kind = {"Float": np.float64, "Int": np.int64}[item.get("NumberType")]
    assert values.dtype == kind and item.get("Precision") == "8"
    return values


def check_xdmf(folder):
    root = ElementTree.parse(folder / "record.xdmf").getroot()
    collection = root.find("Domain/Grid")
    assert collection.get("CollectionType") == "Temporal"
    grids = collection.findall("Grid")
    assert len(grids) == len(SNAPSHOTS)
    for grid, (time, topology, positions, cells, fields) in zip(grids, SNAPSHOTS):
        assert float(grid.find("Time").get("Value")) == time
        assert grid.find("Topology").get("TopologyType") == topology
        assert int(grid.find("Topology").get("NumberOfElements")) == len(cells)
        np.testing.assert_array_equal(read_item(folder, grid.find("Topology/DataItem")), cells)
        np.testing.assert_array_equal(read_item(folder, grid.find("Geometry/DataItem")), positions)
        attributes = {a.get("Name"): a for a in grid.findall("Attribute")}
        assert set(attributes) == set(fields)
        for name, values in fields.items():
            kind = "Vector" if np.ndim(values) == 2 else "Scalar"
            assert attributes[name].get("AttributeType") == kind
            np.testing.assert_array_equal(read_item(folder, attributes[name].find("DataItem")), values)


def check_meshio(folder):
    """meshio takes the mesh of the first time for all, so later meshes are read one by one above."""
    with meshio.xdmf.TimeSeriesReader(folder / "record.xdmf") as reader:
        points, cells = reader.read_points_cells()
        np.testing.assert_array_equal(points, CLOUD)
        assert [(block.type, block.data.tolist()) for block in cells] == [
            ("vertex", [[0], [1], [2]])]
        assert reader.num_steps == len(SNAPSHOTS)
        for number, (time, _, _, _, fields) in enumerate(SNAPSHOTS):
            read_time, data, _ = reader.read_data(number)
            assert read_time == time and set(data) == set(fields)
            for name, values in fields.items():
                np.testing.assert_array_equal(data[name], values)


def main():
    folder = pathlib.Path(sys.argv[1])
    check_hdf5(folder)
    check_xdmf(folder)
    check_meshio(folder)
    check_vtk(folder)
    assert json.loads((folder / "manifest.json").read_text())["outcome"] == "finished"
    print("record, xdmf and VTK agree")


main()
