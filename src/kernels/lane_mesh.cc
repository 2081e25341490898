// SPDX-License-Identifier: MIT
#include "kernels/lane_mesh.h"

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
    for (int corner = 0; corner < corner_count<Dim>; ++corner)
      node_numbers_[node_box_.offset(stepped<Dim>(element, corner, 1))] = 0;
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
      node_runs_.push_back({node_numbers_[offset], node, 1});
    }
    first_runs_[line + 1] = static_cast<int>(node_runs_.size());
  });
}

/// A ring: when a line is passed, sums exist from it up to the line diagonally above it, one plane further.
template <int Dim>
void LaneMesh<Dim>::lay_out_window() {
  const std::int64_t lines_of_plane = line_count() / node_box_.size[Dim - 1];
  const std::int64_t live_lines = lines_of_plane + (Dim == 3 ? 2 : 1);
  const auto first_node = [&](std::int64_t line) {
    const int run = first_runs_[std::min(line, line_count())];
    return run < static_cast<int>(node_runs_.size()) ? node_runs_[run].node : node_count_;
  };
  std::int64_t longest = 0, most = 0;
  for (std::int64_t line = 0; line < line_count(); ++line) {
    longest = std::max(longest, first_node(line + 1) - first_node(line));
    most = std::max(most, first_node(line + live_lines) - first_node(line));
  }
  // Lines stay in one piece: less than the longest may be left over at the end.
  window_ = most + longest;
  std::int64_t next = 0;
  for (std::int64_t line = 0; line < line_count(); ++line) {
    const std::int64_t length = first_node(line + 1) - first_node(line);
    if (next + length > window_) next = 0;
    slots_.push_back(next);
    next += length;
  }
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
      const Index<Dim> node = stepped<Dim>(element, 2 * corner, 1);
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

/// Rows finish what they touch last, up to the first shared node behind one that is not.
template <int Dim>
void LaneMesh<Dim>::set_shared(std::span<const std::int64_t> nodes) {
  const auto position = [&](std::int64_t node) {
    const auto found = std::lower_bound(nodes.begin(), nodes.end(), node);
    return found != nodes.end() && *found == node ? found - nodes.begin() : std::ptrdiff_t{-1};
  };
  for (Row& row : rows_) {
    row.finish_begin = 0;
    while (row.finish_begin <= row.length && position(row.node[0] + row.finish_begin) >= 0)
      ++row.finish_begin;
    row.finish_end = row.finish_begin;
    while (row.finish_end <= row.length && position(row.node[0] + row.finish_end) < 0) ++row.finish_end;
  }
  segments_.clear();
  for (Line& line : lines_) {
    line.first_segment = static_cast<int>(segments_.size());
    const std::int64_t start = node_runs_[first_runs_[line.line]].node;
    const NodeRun& last = node_runs_[first_runs_[line.line + 1] - 1];
    int row = line.first_row;
    std::int64_t previous = -2;
    for (std::int64_t node = start; node < last.node + last.length; ++node) {
      while (row < line.last_row && node >= rows_[row].node[0] + rows_[row].finish_end) ++row;
      if (row < line.last_row && node >= rows_[row].node[0] + rows_[row].finish_begin) continue;
      const std::int64_t shared = position(node);
      if (node == previous + 1 && (segments_.back().shared >= 0) == (shared >= 0))
        ++segments_.back().length;
      else
        segments_.push_back({node, slots_[line.line] + node - start, shared, 1});
      previous = node;
    }
    line.last_segment = static_cast<int>(segments_.size());
  }
}

FABSEQ_INSTANTIATE_CLASS(LaneMesh);

}  // namespace fabseq
