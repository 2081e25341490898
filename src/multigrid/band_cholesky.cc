// SPDX-License-Identifier: MIT
#include "multigrid/band_cholesky.h"

#include "fabseq/base/blas.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

template <int Dim>
BandNumbering<Dim>::BandNumbering(const LaneMesh<Dim>& mesh, int components) {
  std::array<int, Dim> axes;
  std::iota(axes.begin(), axes.end(), 0);
  const IndexBox<Dim>& box = mesh.node_box();
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return box.size[a] < box.size[b]; });
  IndexBox<Dim> permuted;
  for (int axis = 0; axis < Dim; ++axis) permuted.size[axis] = box.size[axes[axis]];
  rows.assign(static_cast<std::size_t>(mesh.nodes()) * components, 0);
  int next = 0;
  permuted.for_each([&](const Index<Dim>& place, std::int64_t) {
    Index<Dim> node = box.start;
    for (int axis = 0; axis < Dim; ++axis) node[axes[axis]] += place[axis];
    const std::int64_t number = mesh.node_number(node);
    if (number < 0) return;
    for (int a = 0; a < components; ++a) rows[number * components + a] = next++;
  });
  for (const auto& row : mesh.rows())
    for (int i = 0; i < row.length; ++i) {
      int lowest = static_cast<int>(rows.size()), highest = 0;
      for (const std::int64_t first : row.node)
        for (int side = 0; side < 2; ++side) {
          const int of_node = rows[(first + i + side) * components];
          lowest = std::min(lowest, of_node);
          highest = std::max(highest, of_node + components - 1);
        }
      bandwidth = std::max(bandwidth, highest - lowest);
    }
}

void BandCholesky::resize(int size, int bandwidth) {
  size_ = size;
  bandwidth_ = bandwidth;
  band_.assign(static_cast<std::size_t>(size) * (bandwidth + 1), 0.0);
}

bool BandCholesky::factor() {
  const int leading = bandwidth_ + 1;
  for (int row = 0; row < size_; ++row) {
    double& diagonal = band_[static_cast<std::size_t>(row) * leading];
    if (diagonal == 0.0) diagonal = 1.0;
  }
  int info = 0;
  dpbtrf_("L", &size_, &bandwidth_, band_.data(), &leading, &info);
  return info == 0;
}

int BandCholesky::last_row(int column) const {
  int row = std::min(column + bandwidth_, size_ - 1);
  while (row > column && entry(row, column) == 0.0) --row;
  return row;
}

void BandCholesky::solve(std::span<double> values) const {
  const int leading = bandwidth_ + 1;
  const int columns = 1;
  int info = 0;
  dpbtrs_("L", &size_, &bandwidth_, &columns, band_.data(), &leading, values.data(), &size_, &info);
}

FABSEQ_INSTANTIATE_STRUCT(BandNumbering);

}  // namespace fabseq
