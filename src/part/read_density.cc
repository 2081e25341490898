// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/hdf5.h"
#include "fabseq/base/mpi.h"
#include "fabseq/part/part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

/// Work of an element outside part and substrate, relative to that of one inside.
constexpr double void_weight = 0.1;

template <int Dim>
std::vector<double> evaluate_shape(const Domain<Dim>& domain, const Shape& shape, const IndexBox<Dim>& box) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < Dim; ++axis)
    smallest = std::min(smallest, domain.size[axis] / domain.elements[axis]);
  std::vector<double> density(static_cast<std::size_t>(box.count()));
  box.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    density[offset] = shape.contains(domain.element_center(element), shape_tolerance * smallest) ? 1.0 : 0.0;
  });
  return density;
}

/// Mean of the samples of each element of `box`.
template <int Dim>
std::vector<double> means(const std::vector<double>& samples, const IndexBox<Dim>& of_samples,
                          const IndexBox<Dim>& box, int sampling) {
  std::vector<double> sums(static_cast<std::size_t>(box.count()), 0.0);
  of_samples.for_each([&](const Index<Dim>& sample, std::int64_t offset) {
    Index<Dim> element = sample;
    for (int& index : element) index /= sampling;
    sums[box.offset(element)] += samples[offset];
  });
  for (double& value : sums) value /= std::pow(sampling, Dim);
  return sums;
}

/// Densities so little beyond 0 and 1 are rounded, as by a filter or in single precision.
constexpr double rounding = 1e-6;

/// Throws InputError on all ranks for densities that are NaN or, without a threshold, not between 0 and 1,
/// and brings those there that are beyond by rounding.
void require_densities(MPI_Comm comm, std::vector<double>& density, const VoxelFile& voxels) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  std::int64_t not_a_number = 0;
  for (const double value : density) {
    if (std::isnan(value)) ++not_a_number;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  not_a_number = sum(comm, not_a_number);
  lowest = min(comm, lowest);
  highest = max(comm, highest);
  const std::string name =
      "/part/voxels/dataset: dataset '" + voxels.dataset + "' of '" + voxels.file + "' has ";
  if (not_a_number > 0)
    throw InputError(name + std::to_string(not_a_number) +
                     " values that are not a number, needs densities from 0 to 1");
  if (voxels.threshold) return;
  if (lowest < -rounding || highest > 1.0 + rounding)
    throw InputError(name + formatted("values from %.10g to %.10g", lowest, highest) +
                     ", needs densities from 0 to 1 or a threshold");
  for (double& value : density) value = std::clamp(value, 0.0, 1.0);
}

/// Number of elements that a file has along each axis. Throws InputError unless these are those of `domain`
/// or up to `sampling` - 1 planes fewer.
template <int Dim>
Index<Dim> elements_of(const Hdf5ParallelDataset& dataset, const Domain<Dim>& domain, int sampling) {
  Index<Dim> found = domain.elements;
  std::array<hsize_t, Dim> shape;  // axes of the file run the other way: [z][y][x]
  for (int axis = 0; axis < Dim; ++axis) {
    hsize_t& extent = shape[Dim - 1 - axis];
    extent = static_cast<hsize_t>(domain.elements[axis]);
    if (dataset.shape().size() != Dim) continue;
    const hsize_t missing = extent - dataset.shape()[Dim - 1 - axis];  // huge if the file has more
    if (missing < static_cast<hsize_t>(sampling)) extent -= missing;
    found[axis] = static_cast<int>(extent);
  }
  dataset.require_shape(shape, sampling == 1
                                   ? "domain.elements reversed"
                                   : "domain.elements times part.sampling reversed, or planes fewer");
  return found;
}

/// Densities of the elements of `box`, 0 for those that the file lacks.
template <int Dim>
std::vector<double> read_box(const Hdf5ParallelDataset& dataset, const Index<Dim>& there,
                             const IndexBox<Dim>& box) {
  IndexBox<Dim> read = box;
  std::array<hsize_t, Dim> start, count;
  for (int axis = 0; axis < Dim; ++axis) {
    read.size[axis] = std::clamp(there[axis] - box.start[axis], 0, box.size[axis]);
    start[Dim - 1 - axis] = static_cast<hsize_t>(read.size[axis] > 0 ? box.start[axis] : 0);
    count[Dim - 1 - axis] = static_cast<hsize_t>(read.size[axis]);
  }
  std::vector<double> values = dataset.read(start, count);
  if (read.size == box.size) return values;
  std::vector<double> density(static_cast<std::size_t>(box.count()), 0.0);
  read.for_each(
      [&](const Index<Dim>& element, std::int64_t offset) { density[box.offset(element)] = values[offset]; });
  return density;
}

/// The values of `coarse`, each of which stands `factor` times along each axis of `fine`.
template <int Dim>
std::vector<double> repeated(const std::vector<double>& values, const IndexBox<Dim>& coarse,
                             const IndexBox<Dim>& fine, int factor) {
  std::vector<double> result(static_cast<std::size_t>(fine.count()));
  fine.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    Index<Dim> there = element;
    for (int& index : there) index /= factor;
    result[offset] = values[coarse.offset(there)];
  });
  return result;
}

template <int Dim>
std::vector<double> read_voxels(MPI_Comm comm, const Domain<Dim>& domain, const VoxelFile& voxels,
                                int sampling, const IndexBox<Dim>& box) {
  const Hdf5ParallelDataset dataset(comm, voxels.file, voxels.dataset, "/part/voxels/file",
                                    "/part/voxels/dataset");
  Domain<Dim> in_file = domain;
  IndexBox<Dim> box_in_file = box;
  for (int axis = 0; axis < Dim; ++axis) {
    in_file.elements[axis] /= voxels.repeat;
    box_in_file.start[axis] /= voxels.repeat;
    const int last = box.start[axis] + box.size[axis] - 1;
    if (box.size[axis] > 0) box_in_file.size[axis] = last / voxels.repeat + 1 - box_in_file.start[axis];
  }
  std::vector<double> density =
      read_box<Dim>(dataset, elements_of<Dim>(dataset, in_file, sampling), box_in_file);
  require_densities(comm, density, voxels);
  if (voxels.threshold)
    for (double& value : density) value = value >= *voxels.threshold ? 1.0 : 0.0;
  return voxels.repeat == 1 ? density : repeated<Dim>(density, box_in_file, box, voxels.repeat);
}

/// Shares of elements inside a mesh, or 1 and 0 by them.
template <int Dim>
std::vector<double> evaluate_mesh(const Domain<Dim>& domain, const PartDescription& description,
                                  const IndexBox<Dim>& box, Clarity* clarity) {
  if constexpr (Dim == 3) {
    FillFractions fractions = description.mesh->fill(domain, box);
    if (clarity != nullptr) *clarity = fractions.clarity;
    const std::optional<double>& least = std::get<MeshFile>(description.source).fill;
    if (least)
      for (double& value : fractions.of_element) value = value >= *least ? 1.0 : 0.0;
    return std::move(fractions.of_element);
  }
  throw InputError("/part/mesh: in a plane, needs a domain of 3 dimensions");
}

}  // namespace

template <int Dim>
std::vector<double> read_density(MPI_Comm comm, const Domain<Dim>& domain, const PartDescription& description,
                                 const IndexBox<Dim>& box, Clarity* clarity) {
  const int sampling = description.sampling;
  Domain<Dim> finer = domain;
  IndexBox<Dim> of_samples = box;
  for (int axis = 0; axis < Dim; ++axis) {
    finer.elements[axis] *= sampling;
    of_samples.start[axis] *= sampling;
    of_samples.size[axis] *= sampling;
  }
  std::vector<double> samples;
  if (const auto* voxels = std::get_if<VoxelFile>(&description.source))
    samples = read_voxels<Dim>(comm, finer, *voxels, sampling, of_samples);
  else if (const auto* shape = std::get_if<Shape>(&description.source))
    samples = evaluate_shape<Dim>(finer, *shape, of_samples);
  else
    samples = evaluate_mesh<Dim>(finer, description, of_samples, clarity);
  return sampling == 1 ? samples : means<Dim>(samples, of_samples, box, sampling);
}

template <int Dim>
double add_stock(const Domain<Dim>& domain, const PartDescription& description, const IndexBox<Dim>& box,
                 std::span<double> density) {
  if (!description.stock) return 0.0;
  const std::vector<double> stock = evaluate_shape<Dim>(domain, *description.stock, box);
  double added = 0.0;
  for (std::size_t e = 0; e < density.size(); ++e) {
    added += std::max(0.0, stock[e] - density[e]);
    density[e] = std::max(density[e], stock[e]);
  }
  return added;
}

template <int Dim>
ElementWeights<Dim> element_weights(MPI_Comm comm, const Domain<Dim>& domain,
                                    const PartDescription& description) {
  return [comm, domain, &description](const IndexBox<Dim>& box) {
    std::vector<double> weights = read_density<Dim>(comm, domain, description, box);
    add_stock<Dim>(domain, description, box, weights);
    if (description.substrate) {
      const std::vector<double> substrate = evaluate_shape<Dim>(domain, *description.substrate, box);
      for (std::size_t e = 0; e < weights.size(); ++e) weights[e] = std::max(weights[e], substrate[e]);
    }
    for (double& value : weights) value = value > 0.0 ? 1.0 : void_weight;
    return weights;
  };
}

template <int Dim>
Grid<Dim> make_balanced_grid(MPI_Comm comm, const Domain<Dim>& domain, const PartDescription& description) {
  return Grid<Dim>(comm, domain, element_weights<Dim>(comm, domain, description));
}

FABSEQ_INSTANTIATE_FUNCTION(read_density);
FABSEQ_INSTANTIATE_FUNCTION(add_stock);
template ElementWeights<3> element_weights<3>(MPI_Comm, const Domain<3>&, const PartDescription&);
FABSEQ_INSTANTIATE_FUNCTION(make_balanced_grid);

}  // namespace fabseq
