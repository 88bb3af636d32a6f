#include "scene/snapshot.hpp"

#include "scene/hdf5_file.hpp"
#include "scene/record_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>

namespace sprung {
namespace {

void check_shapes(const SnapshotData& data, double time) {
  const std::string where = "snapshot at " + shortest(time) + " s: ";
  if (data.positions.size() % 3 != 0) throw std::logic_error(where + "positions are 3 per point");
  const auto points = data.positions.size() / 3;
  if (data.nodes_per_cell > 0) {
    if (data.nodes_per_cell != 3 && data.nodes_per_cell != 4)
      throw std::logic_error(where + "cells have 3 or 4 nodes");
    if (data.cells.size() % static_cast<std::size_t>(data.nodes_per_cell) != 0)
      throw std::logic_error(where + "the cells' nodes do not fill whole cells");
    for (const auto node : data.cells)
      if (node < 0 || static_cast<std::size_t>(node) >= points)
        throw std::logic_error(where + "a cell names the node " + std::to_string(node) +
                               ", which does not exist");
  }
  require_finite(data.positions, where + "a position");
  std::set<std::string> names;
  for (const auto& field : *data.fields) {
    require_name(field.name, "field");
    if (field.components < 1 ||
        field.values.size() != points * static_cast<std::size_t>(field.components))
      throw std::logic_error(where + field.name + " has " + std::to_string(field.values.size()) +
                             " values for " + std::to_string(points) + " points of " +
                             std::to_string(field.components) + " components");
    if (!names.insert(field.name).second) throw std::logic_error(where + field.name + " twice");
    require_finite(field.values, where + field.name);
  }
}

/// Plane vectors with a third component 0: ParaView takes three for a vector.
std::vector<double> padded(std::span<const double> plane) {
  std::vector<double> spatial;
  spatial.reserve(plane.size() / 2 * 3);
  for (std::size_t i = 0; i + 1 < plane.size(); i += 2)
    spatial.insert(spatial.end(), {plane[i], plane[i + 1], 0.0});
  return spatial;
}

const char* attribute_type(int components) {
  switch (components) {
    case 1:
      return "Scalar";
    case 3:
      return "Vector";
    case 6:
      return "Tensor6";
    case 9:
      return "Tensor";
    default:
      return "Matrix";
  }
}

std::string data_item(const std::string& number, const std::string& dimensions,
                      const std::string& place) {
  return "<DataItem Format=\"HDF\" " + number + " Precision=\"8\" Dimensions=\"" + dimensions +
         "\">" + place + "</DataItem>\n";
}

std::string grid_text(const Snapshot& snapshot) {
  const std::string file = snapshot_file(snapshot.index) + ":/";
  const std::string points = std::to_string(snapshot.points);
  const std::string real = "NumberType=\"Float\"";
  std::string text = "      <Grid Name=\"fields\" GridType=\"Uniform\">\n        <Time Value=\"" +
                     shortest(snapshot.time) + "\"/>\n";
  if (snapshot.nodes_per_cell == 0) {
    text += "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + points +
            "\" NodesPerElement=\"1\">\n          " +
            data_item("NumberType=\"Int\"", points + " 1", file + "cells") +
            "        </Topology>\n";
  } else {
    const std::string cells = std::to_string(snapshot.cells);
    text += std::string("        <Topology TopologyType=\"") +
            (snapshot.nodes_per_cell == 3 ? "Triangle" : "Quadrilateral") +
            "\" NumberOfElements=\"" + cells + "\">\n          " +
            data_item("NumberType=\"Int\"", cells + " " + std::to_string(snapshot.nodes_per_cell),
                      file + "cells") +
            "        </Topology>\n";
  }
  text += "        <Geometry GeometryType=\"XYZ\">\n          " +
          data_item(real, points + " 3", file + "positions") + "        </Geometry>\n";
  for (const auto& field : snapshot.fields)
    text +=
        "        <Attribute Name=\"" + field.name + "\" AttributeType=\"" +
        attribute_type(field.components) + "\" Center=\"Node\">\n          " +
        data_item(real,
                  field.components == 1 ? points : points + " " + std::to_string(field.components),
                  file + "fields/" + field.name) +
        "        </Attribute>\n";
  return text + "      </Grid>\n";
}

/// The group that VTK's own reader looks for (VTKHDF 1.0, unstructured grid of one part): mostly
/// second names of what is there already.
void add_vtk_view(hdf5::Output& output, const Snapshot& snapshot,
                  std::span<const std::int64_t> nodes) {
  output.group("/VTKHDF/PointData");
  output.attribute("/VTKHDF", "Version", std::vector<std::int64_t>{1, 0});
  output.fixed_attribute("/VTKHDF", "Type", "UnstructuredGrid");
  const auto count = [&](const std::string& name, std::size_t value) {
    output.write("/VTKHDF/" + name, std::array{static_cast<std::int64_t>(value)}, {1});
  };
  count("NumberOfPoints", snapshot.points);
  count("NumberOfCells", snapshot.cells);
  count("NumberOfConnectivityIds", nodes.size());
  output.alias("/VTKHDF/Points", "/positions");
  output.write("/VTKHDF/Connectivity", nodes, {nodes.size()});
  std::vector<std::int64_t> offsets(snapshot.cells + 1);
  const std::size_t each = snapshot.cells > 0 ? nodes.size() / snapshot.cells : 0;
  for (std::size_t c = 0; c < offsets.size(); ++c)
    offsets[c] = static_cast<std::int64_t>(c * each);
  output.write("/VTKHDF/Offsets", offsets, {offsets.size()});
  // VTK's numbers of a vertex, a triangle and a quadrilateral.
  const std::uint8_t type = each == 3 ? 5 : each == 4 ? 9 : 1;
  output.write("/VTKHDF/Types", std::vector<std::uint8_t>(snapshot.cells, type), {snapshot.cells});
  for (const auto& field : snapshot.fields)
    output.alias("/VTKHDF/PointData/" + field.name, "/fields/" + field.name);
}

}  // namespace

std::string snapshot_file(int index) {
  char name[32];
  std::snprintf(name, sizeof name, "fields/%06d.vtkhdf", index);
  return name;
}

Snapshot write_snapshot(const std::filesystem::path& folder, int index, double time,
                        const SnapshotData& data) {
  check_shapes(data, time);
  Snapshot snapshot{index, time, data.positions.size() / 3, 0, data.nodes_per_cell, {}};
  hdf5::Output output(folder / snapshot_file(index));
  output.attribute("/", "time", time);
  output.attribute("/", "nodes_per_cell", static_cast<double>(data.nodes_per_cell));
  output.write("/positions", data.positions, {snapshot.points, 3});
  std::vector<std::int64_t> vertices;
  if (data.nodes_per_cell > 0) {
    const auto nodes = static_cast<std::size_t>(data.nodes_per_cell);
    snapshot.cells = data.cells.size() / nodes;
    output.write("/cells", data.cells, {snapshot.cells, nodes});
  } else {
    // Readers differ on a cloud without connectivity; with it they agree.
    vertices.resize(snapshot.points);
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = static_cast<std::int64_t>(i);
    snapshot.cells = snapshot.points;
    output.write("/cells", vertices, {snapshot.points, 1});
  }
  output.group("/fields");
  for (const auto& field : *data.fields) {
    const bool plane = field.components == 2;
    const auto spatial = plane ? padded(field.values) : std::vector<double>{};
    const int components = plane ? 3 : field.components;
    hdf5::Shape shape{snapshot.points};
    if (components > 1) shape.push_back(static_cast<hsize_t>(components));
    output.write("/fields/" + field.name, plane ? std::span<const double>(spatial) : field.values,
                 shape);
    snapshot.fields.push_back({field.name, components});
  }
  add_vtk_view(output, snapshot, data.nodes_per_cell > 0 ? data.cells : vertices);
  output.commit();
  std::sort(snapshot.fields.begin(), snapshot.fields.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return snapshot;
}

Snapshot read_snapshot(const std::filesystem::path& folder, int index) {
  const hdf5::Input input(folder / snapshot_file(index));
  Snapshot snapshot;
  snapshot.index = index;
  snapshot.time = input.number("/", "time");
  snapshot.nodes_per_cell = static_cast<int>(input.number("/", "nodes_per_cell"));
  snapshot.points = input.shape("/positions").at(0);
  snapshot.cells = input.shape("/cells").at(0);
  for (const auto& name : input.names("/fields")) {
    const auto shape = input.shape("/fields/" + name);
    snapshot.fields.push_back({name, shape.size() > 1 ? static_cast<int>(shape[1]) : 1});
  }
  return snapshot;
}

std::string xdmf_text(const std::vector<Snapshot>& snapshots) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"3.0\">\n"
      "  <Domain>\n    <Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (const auto& snapshot : snapshots) text += grid_text(snapshot);
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

}  // namespace sprung
