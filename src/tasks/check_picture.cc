// SPDX-License-Identifier: MIT
/// The picture of -task check: elements by the layers of the start design, the plate, node sets.
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/optimize/stages.h"
#include "fabseq/output/task_directory.h"
#include "fabseq/tasks/starting_design.h"
#include "fabseq/tasks/tasks.h"
#include "tasks/voxel_picture.h"

#include <algorithm>
#include <filesystem>

namespace fabseq {

namespace {

/// More cells along an axis are joined, and more nodes of a set are left out: nobody would see them.
constexpr int most_cells = 72;
constexpr std::size_t most_nodes = 2000;
constexpr std::array<const char*, 5> set_colors = {"#111111", "#c2185b", "#00695c", "#5d4037", "#283593"};

/// Early layers dark blue, late ones yellow.
VoxelPicture::Color color_of_share(double share) {
  constexpr std::array<VoxelPicture::Color, 5> stops = {
      {{0.16, 0.22, 0.55}, {0.13, 0.47, 0.62}, {0.22, 0.66, 0.47}, {0.66, 0.80, 0.27}, {0.98, 0.88, 0.27}}};
  const double place = std::clamp(share, 0.0, 1.0) * (stops.size() - 1.0);
  const auto below = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const double rest = place - static_cast<double>(below);
  VoxelPicture::Color result;
  for (int i = 0; i < 3; ++i) result[i] = (1.0 - rest) * stops[below][i] + rest * stops[below + 1][i];
  return result;
}

/// The layer that builds each part element in the start design, 1 to N (a part field). Collective.
template <int Dim>
std::vector<double> start_layers(const Setup<Dim>& setup, const CommandLine& command_line) {
  const auto sequence = make_sequence<Dim>(setup, setup.config.solver.finest_tolerance());
  const Design design = starting_design(setup, *sequence, command_line);
  const std::vector<double>& time = sequence->update(setup.groups.gather(design.field)).time;
  const auto layers = setup.layers->make(design.layer_variables, 0.0, true, {});
  LayerDensities densities;
  layers->set_densities(time, densities);
  return layers->layer_index(time, densities);
}

/// Cells of the picture, each of `factor` elements along an axis, on all ranks: 0 for none, 1 for the
/// substrate, 1 + j for layer j, the latest one among the elements of a cell.
template <int Dim>
struct Cells {
  Index<3> count{{1, 1, 1}};
  int factor = 1;
  std::vector<double> content;

  Cells(const Setup<Dim>& setup, const std::vector<double>& layer) {
    const Index<Dim>& elements = setup.grid.domain().elements;
    factor = (*std::max_element(elements.begin(), elements.end()) - 1) / most_cells + 1;
    for (int axis = 0; axis < Dim; ++axis) count[axis] = (elements[axis] - 1) / factor + 1;
    content.assign(static_cast<std::size_t>(box().count()), 0.0);
    const IndexBox<Dim>& owned = setup.grid.owned_elements();
    const std::vector<double> layers = setup.part.expand(layer);
    owned.for_each([&](const Index<Dim>& element, std::int64_t offset) {
      const bool substrate = setup.part.substrate().elements()[offset] != 0;
      double& cell = content[box().offset(cell_of(element))];
      cell = std::max(cell, substrate ? 1.0 : layers[offset] > 0.0 ? 1.0 + layers[offset] : 0.0);
    });
    max_in_place(setup.grid.comm(), content);
  }

  IndexBox<3> box() const { return {{}, count}; }
  Index<3> cell_of(const Index<Dim>& element) const {
    Index<3> cell{};
    for (int axis = 0; axis < Dim; ++axis) cell[axis] = element[axis] / factor;
    return cell;
  }
};

/// Nodes of a set on all ranks, in cells of the picture.
template <int Dim>
std::vector<Point<3>> places(const Setup<Dim>& setup, const NodeSet& set, int factor) {
  std::vector<std::int64_t> own;
  for (const int node : set.owned)
    own.push_back(setup.grid.all_nodes().offset(setup.grid.owned_nodes().index(node)));
  const std::vector<std::int64_t> all = gather_all(setup.grid.comm(), own);
  std::vector<Point<3>> result;
  const std::size_t step = all.size() / most_nodes + 1;
  for (std::size_t i = 0; i < all.size(); i += step) {
    const Index<Dim> node = setup.grid.all_nodes().index(all[i]);
    Point<3>& place = result.emplace_back();
    for (int axis = 0; axis < Dim; ++axis) place[axis] = static_cast<double>(node[axis]) / factor;
  }
  return result;
}

template <int Dim>
std::string picture(const Setup<Dim>& setup, const CommandLine& command_line) {
  const Cells<Dim> cells(setup, start_layers(setup, command_line));
  Point<3> size = {1.0, 1.0, 1.0};
  for (int axis = 0; axis < Dim; ++axis)
    size[axis] = cells.count[axis] * cells.factor * setup.grid.spacing()[axis];
  if (Dim == 2) size[2] = 1e-3 * std::min(size[0], size[1]);
  VoxelPicture picture(cells.count, size, Dim == 2);
  const auto count = static_cast<int>(*std::max_element(cells.content.begin(), cells.content.end())) - 1;
  std::vector<VoxelPicture::Color> palette = {{0.72, 0.72, 0.72}};
  for (int layer = 1; layer <= count; ++layer)
    palette.push_back(color_of_share((layer - 0.5) / std::max(count, 1)));
  std::vector<int> colors;
  for (const double content : cells.content) colors.push_back(static_cast<int>(content) - 1);

  picture.draw_side(setup.config.plate.axis, setup.config.plate.upper, "#d8d2c4");
  picture.add_legend("#d8d2c4", "build plate " + setup.config.plate.name());
  picture.draw_cells(colors, palette);
  if (setup.part.substrate().count() > 0) picture.add_legend(hex(palette[0], 1.0), "substrate");
  if (count > 0) {
    picture.add_legend(hex(palette[1], 1.0), "layer 1 of the start design");
    picture.add_legend(hex(palette.back(), 1.0), "layer " + std::to_string(count));
  }
  std::size_t number = 0;
  for (const auto& [name, set] : setup.node_sets) {
    const char* color = set_colors[number++ % set_colors.size()];
    picture.draw_points(places(setup, set, cells.factor), color);
    picture.add_legend(color, "node set " + name + ", " + std::to_string(set.count) + " nodes");
  }
  return picture.svg(setup.config.name + ": " + to_text<Dim>(setup.grid.domain().elements) + " elements" +
                     (cells.factor > 1 ? ", drawn in blocks of " + std::to_string(cells.factor) : ""));
}

}  // namespace

template <int Dim>
void write_check_picture(const Setup<Dim>& setup, const CommandLine& command_line) {
  const std::string directory = output_path(setup.config, command_line), file = directory + "/check.svg";
  const std::string text = picture(setup, command_line);
  run_on_first(setup.world(), [&] {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) throw OutputError("cannot make output directory '" + directory + "': " + error.message());
    replace_file(file, text);
  });
  print("picture: " + file);
}

FABSEQ_INSTANTIATE_FUNCTION(write_check_picture);

}  // namespace fabseq
