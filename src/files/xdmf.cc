// SPDX-License-Identifier: MIT
#include "files/xdmf.h"

#include "fabseq/base/formatted.h"

#include <vector>

namespace fabseq {

namespace {

/// Entries of an index or a point in XDMF's order z y x, with `third` for the missing z axis of a 2D grid.
template <class Entries>
std::vector<double> slowest_first(const Entries& entries, double third) {
  std::vector<double> result(entries.rbegin(), entries.rend());
  if (result.size() == 2) result.insert(result.begin(), third);
  return result;
}

std::string list_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + formatted("%.17g", value);
  return text;
}

std::string triple_item(const std::vector<double>& values) {
  return "        <DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">" +
         list_text(values) + "</DataItem>\n";
}

template <int Dim>
std::string field_text(const Grid<Dim>& grid, const typename FieldSet<Dim>::Field& field,
                       const XdmfSource& source) {
  std::vector<double> shape =
      slowest_first(field.on_nodes ? grid.all_nodes().size : grid.all_elements().size, /*third=*/1.0);
  if (field.components > 1) shape.push_back(field.components);
  const bool is_vector = field.components == Dim;
  const std::string type = field.components == 1 ? "Scalar" : is_vector ? "Vector" : "Matrix";
  return "      <Attribute Name=\"" + field.name + "\" AttributeType=\"" + type + "\" Center=\"" +
         (field.on_nodes ? "Node" : "Cell") + "\">\n        <DataItem Dimensions=\"" + list_text(shape) +
         "\" NumberType=\"Float\" Precision=\"" + (field.single_precision ? "4" : "8") + "\" " +
         source.attributes + ">" + source.content + "</DataItem>\n      </Attribute>\n";
}

}  // namespace

template <int Dim>
std::string xdmf_text(const FieldSet<Dim>& fields, const std::function<XdmfSource(std::size_t)>& source,
                      std::optional<double> moment) {
  const Grid<Dim>& grid = *fields.grid;
  std::string text =
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n    <Grid Name=\"fabseq\" "
      "GridType=\"Uniform\">\n";
  if (moment) text += formatted("      <Time Value=\"%.17g\"/>\n", *moment);
  text += "      <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"" +
          list_text(slowest_first(grid.all_nodes().size, 1.0)) +
          "\"/>\n      <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n" +
          triple_item(slowest_first(grid.domain().origin, 0.0)) +
          triple_item(slowest_first(grid.spacing(), 1.0)) + "      </Geometry>\n";
  for (std::size_t i = 0; i < fields.fields.size(); ++i)
    text += field_text<Dim>(grid, fields.fields[i], source(i));
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

FABSEQ_INSTANTIATE_FUNCTION(xdmf_text);

}  // namespace fabseq
