// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fabseq {

/// The elements of a box that are in the model, and the nodes they touch, both numbered without gaps, x
/// fastest: arrays hold nothing of what is not there. Kernels walk along rows of elements that follow each
/// other in x; the nodes of such a row follow each other, too. A node's sum is complete once the row that
/// starts at it has been passed, so that kernels need the sums of little more than a plane (2D: a line) at a
/// time: the window.
template <int Dim>
class LaneMesh {
 public:
  /// Corners of an element's face across x.
  static constexpr int face_corners = corner_count<Dim> / 2;

  /// Elements next to each other along x.
  struct Row {
    std::int64_t element = 0;                       ///< number of the first
    std::array<std::int64_t, face_corners> node{};  ///< numbers of the corners of its lower face across x
    std::array<std::int64_t, face_corners> slot{};  ///< where these nodes' sums are in the window
    int length = 0;
    /// Nodes of corner 0, counted along the row, half-open, that kernels finish while they pass it.
    int finish_begin = 0, finish_end = 0;
    std::int64_t line = 0;  ///< line of nodes it starts at, counted in the node box
  };
  /// Nodes next to each other along x.
  struct NodeRun {
    std::int64_t node = 0;  ///< number of the first
    Index<Dim> index{};     ///< its index
    int length = 0;
  };
  /// Nodes next to each other whose sums are complete once a line has been passed, and which no row finishes.
  struct Segment {
    std::int64_t node = 0;
    std::int64_t slot = 0;
    std::int64_t shared = -1;  ///< position of the first among the shared nodes; -1: not shared
    int length = 0;
  };
  /// What to do for a line of nodes: pass these rows of elements, then these segments are complete.
  struct Line {
    std::int64_t line = 0;            ///< counted in the node box
    int first_row = 0, last_row = 0;  ///< ranges are half-open
    int first_segment = 0, last_segment = 0;
  };

  LaneMesh() = default;
  /// `active`: whether each element of the box is in the model, lexicographic.
  LaneMesh(const IndexBox<Dim>& elements, std::span<const char> active);

  const IndexBox<Dim>& element_box() const { return element_box_; }
  const IndexBox<Dim>& node_box() const { return node_box_; }
  std::int64_t elements() const { return element_count_; }
  std::int64_t nodes() const { return node_count_; }
  /// Nodes the window has room for.
  std::int64_t window() const { return window_; }
  /// Number of an element of the box, or -1.
  int element_number(const Index<Dim>& index) const { return element_numbers_[element_box_.offset(index)]; }
  /// Number of a node of the node box, or -1.
  int node_number(const Index<Dim>& index) const { return node_numbers_[node_box_.offset(index)]; }

  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<NodeRun>& node_runs() const { return node_runs_; }
  const std::vector<Segment>& segments() const { return segments_; }
  const std::vector<Line>& lines() const { return lines_; }

  /// Sums of these nodes (ascending numbers) have parts on other ranks: kernels hand them over apart.
  void set_shared(std::span<const std::int64_t> nodes);

 private:
  void number_nodes();
  void collect_runs();
  void lay_out_window();
  void collect_rows();
  void order_lines();
  /// Lines of nodes of the box.
  std::int64_t line_count() const { return node_box_.count() / node_box_.size[0]; }

  IndexBox<Dim> element_box_, node_box_;
  std::int64_t element_count_ = 0, node_count_ = 0, window_ = 0;
  std::vector<int> element_numbers_, node_numbers_;
  std::vector<std::int64_t> slots_;  ///< of the first node of each line
  std::vector<int> first_runs_;      ///< of each line, and the end
  std::vector<Row> rows_;
  std::vector<NodeRun> node_runs_;
  std::vector<Segment> segments_;
  std::vector<Line> lines_;
};

}  // namespace fabseq
