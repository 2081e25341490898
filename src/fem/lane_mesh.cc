#include "fabseq/fem/lane_mesh.h"

#include <algorithm>

namespace fabseq {

template <int Dim>
LaneMesh<Dim>::LaneMesh(const IndexBox<Dim>& elements, std::span<const char> active)
    : element_box_(elements), node_box_(elements), element_numbers_(active.size(), -1) {
  for (int& extent : node_box_.size) ++extent;
  for (std::size_t e = 0; e < active.size(); ++e)
    if (active[e] != 0) element_numbers_[e] = static_cast<int>(element_count_++);
  number_nodes();
  collect_runs();
  lay_out_window();
  collect_rows();
  order_lines();
  set_shared({});
}

template <int Dim>
void LaneMesh<Dim>::number_nodes() {
  node_numbers_.assign(static_cast<std::size_t>(node_box_.count()), -1);
  element_box_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    if (element_numbers_[offset] < 0) return;
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      Index<Dim> node = element;
      for (int axis = 0; axis < Dim; ++axis) node[axis] += (corner >> axis) & 1;
      node_numbers_[node_box_.offset(node)] = 0;
    }
  });
  for (int& number : node_numbers_)
    if (number == 0) number = static_cast<int>(node_count_++);
}

template <int Dim>
void LaneMesh<Dim>::collect_runs() {
  first_runs_.assign(static_cast<std::size_t>(line_count()) + 1, 0);
  node_box_.for_each([&](const Index<Dim>& node, std::int64_t offset) {
    const std::int64_t line = offset / node_box_.size[0];
    if (node_numbers_[offset] < 0) {
      // The next line starts where this one ends.
    } else if (node[0] > node_box_.start[0] && node_numbers_[offset - 1] >= 0) {
      ++node_runs_.back().length;
    } else {
      node_runs_.push_back({node_numbers_[offset], node, 1, line});
    }
    first_runs_[line + 1] = static_cast<int>(node_runs_.size());
  });
}

/// Planes take turns in the two halves of the window.
template <int Dim>
void LaneMesh<Dim>::lay_out_window() {
  const std::int64_t planes = node_box_.size[Dim - 1];
  const std::int64_t lines_of_plane = line_count() / planes;
  std::int64_t widest = 0;
  for (std::int64_t line = 0; line < line_count(); ++line) {
    const std::int64_t first_run = first_runs_[line / lines_of_plane * lines_of_plane];
    const std::int64_t end = first_runs_[line + 1];
    const bool empty = first_runs_[line] == end;
    slots_.push_back(empty ? 0 : node_runs_[first_runs_[line]].node - node_runs_[first_run].node);
    if (!empty)
      widest = std::max(widest,
                        node_runs_[end - 1].node + node_runs_[end - 1].length - node_runs_[first_run].node);
  }
  for (std::int64_t line = 0; line < line_count(); ++line)
    slots_[line] += (line / lines_of_plane % 2) * widest;
  window_ = 2 * widest;
}

template <int Dim>
void LaneMesh<Dim>::collect_rows() {
  const auto line_start = [&](const Index<Dim>& node) {
    return node_runs_[first_runs_[node_box_.offset(node) / node_box_.size[0]]].node;
  };
  element_box_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    if (element_numbers_[offset] < 0) return;
    if (element[0] > element_box_.start[0] && element_numbers_[offset - 1] >= 0) {
      ++rows_.back().length;
      return;
    }
    Row row;
    row.element = element_numbers_[offset];
    row.length = 1;
    row.line = node_box_.offset(element) / node_box_.size[0];
    for (int corner = 0; corner < face_corners; ++corner) {
      Index<Dim> node = element;
      for (int axis = 1; axis < Dim; ++axis) node[axis] += (corner >> (axis - 1)) & 1;
      row.node[corner] = node_number(node);
      row.slot[corner] =
          slots_[node_box_.offset(node) / node_box_.size[0]] + row.node[corner] - line_start(node);
    }
    rows_.push_back(row);
  });
}

template <int Dim>
void LaneMesh<Dim>::order_lines() {
  std::size_t row = 0;
  for (std::int64_t line = 0; line < line_count(); ++line) {
    if (first_runs_[line] == first_runs_[line + 1]) continue;
    Line entry;
    entry.line = line;
    entry.first_row = static_cast<int>(row);
    while (row < rows_.size() && rows_[row].line == line) ++row;
    entry.last_row = static_cast<int>(row);
    lines_.push_back(entry);
  }
}

template <int Dim>
void LaneMesh<Dim>::set_shared(std::span<const std::int64_t> nodes) {
  segments_.clear();
  for (Line& line : lines_) {
    line.first_segment = static_cast<int>(segments_.size());
    const std::int64_t start = node_runs_[first_runs_[line.line]].node;
    auto next = std::lower_bound(nodes.begin(), nodes.end(), start);
    for (int run = first_runs_[line.line]; run < first_runs_[line.line + 1]; ++run)
      for (int i = 0; i < node_runs_[run].length; ++i) {
        const std::int64_t node = node_runs_[run].node + i;
        const bool shared = next != nodes.end() && *next == node;
        if (i > 0 && (segments_.back().shared >= 0) == shared)
          ++segments_.back().length;
        else
          segments_.push_back(
              {node, slots_[line.line] + node - start, shared ? next - nodes.begin() : -1, 1});
        if (shared) ++next;
      }
    line.last_segment = static_cast<int>(segments_.size());
  }
}

template class LaneMesh<2>;
template class LaneMesh<3>;

}  // namespace fabseq
