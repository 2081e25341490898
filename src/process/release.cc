#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/process/residual_stress.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

extern "C" void dposv_(const char* uplo, const int* n, const int* nrhs, double* a, const int* lda, double* b,
                       const int* ldb, int* info);

namespace fabseq {

namespace {

/// Owned nodes of the model's elements, the plate's too.
template <int Dim>
std::vector<int> model_nodes(const ElasticModel<Dim>& model) {
  SystemDomain free = model.domain;
  std::fill(free.fixed.begin(), free.fixed.end(), 0);
  const UnknownNumbering<Dim> numbering(model.part.grid(), free);
  return numbering.owned_nodes();
}

/// Owned plate nodes of the part. Where the void is quiet, its plate nodes hold nothing: they are as soft as the void.
template <int Dim>
std::vector<int> plate_nodes(const ElasticModel<Dim>& model) {
  std::vector<int> result;
  const auto& touched = model.part.touched_nodes();
  for (std::size_t node = 0; node < touched.size(); ++node)
    if (touched[node] != 0 && model.domain.fixed[node * Dim] != 0) result.push_back(static_cast<int>(node));
  return result;
}

/// The node of all ranks with the largest measure, the lowest lexicographic number among equals.
template <int Dim, class Measure>
Index<Dim> farthest_node(const Grid<Dim>& grid, const std::vector<int>& nodes, Measure&& measure) {
  double largest = -1.0;
  for (const int node : nodes)
    largest = std::max(largest, measure(grid.node_position(grid.owned_nodes().index(node))));
  largest = max(grid.comm(), largest);
  std::int64_t number = grid.all_nodes().count();
  for (const int node : nodes) {
    const Index<Dim> index = grid.owned_nodes().index(node);
    if (measure(grid.node_position(index)) >= largest * (1.0 - 1e-12))
      number = std::min(number, grid.all_nodes().offset(index));
  }
  return grid.all_nodes().index(min(grid.comm(), number));
}

template <std::size_t Size>
std::array<double, Size> difference(const std::array<double, Size>& a, const std::array<double, Size>& b) {
  std::array<double, Size> result{};
  for (std::size_t axis = 0; axis < Size; ++axis) result[axis] = a[axis] - b[axis];
  return result;
}

template <std::size_t Size>
double length(const std::array<double, Size>& v) {
  double square = 0.0;
  for (const double x : v) square += x * x;
  return std::sqrt(square);
}

/// Rotation of position x by a unit rotation number k about the origin: 2D one, 3D about each axis.
template <int Dim>
Point<Dim> rotated(const Point<Dim>& x, int k) {
  Point<Dim> result{};
  const int a = Dim == 2 ? 0 : (k + 1) % 3;
  const int b = Dim == 2 ? 1 : (k + 2) % 3;
  result[a] = -x[b];
  result[b] = x[a];
  return result;
}

template <int Dim>
constexpr int rotation_count = Dim == 2 ? 1 : 3;

/// Supports that hold every rigid motion and nothing else: three nodes in 3D, two in 2D.
template <int Dim>
std::vector<char> statically_determinate_supports(const Grid<Dim>& grid, const std::vector<int>& nodes) {
  std::vector<char> fixed(static_cast<std::size_t>(grid.owned_nodes().count()) * Dim, 0);
  const auto fix = [&](const Index<Dim>& node, int component) {
    if (grid.owned_nodes().contains(node)) fixed[grid.owned_nodes().offset(node) * Dim + component] = 1;
  };
  const auto largest_component = [](const Point<Dim>& v) {
    int best = 0;
    for (int axis = 1; axis < Dim; ++axis)
      if (std::abs(v[axis]) > std::abs(v[best]) * (1.0 + 1e-9)) best = axis;
    return best;
  };
  const Index<Dim> a = farthest_node(grid, nodes, [](const Point<Dim>&) { return 1.0; });
  const Point<Dim> origin = grid.node_position(a);
  const Index<Dim> b =
      farthest_node(grid, nodes, [&](const Point<Dim>& x) { return length(difference(x, origin)); });
  const Point<Dim> edge = difference(grid.node_position(b), origin);
  for (int axis = 0; axis < Dim; ++axis) fix(a, axis);
  for (int axis = 0; axis < Dim; ++axis)
    if (axis != largest_component(edge)) fix(b, axis);
  bool held = length(edge) > 0.0;
  if constexpr (Dim == 3) {
    const auto cross = [&](const Point<3>& x) {
      const Point<3> e = difference(x, origin);
      return Point<3>{edge[1] * e[2] - edge[2] * e[1], edge[2] * e[0] - edge[0] * e[2],
                      edge[0] * e[1] - edge[1] * e[0]};
    };
    const Index<3> c = farthest_node(grid, nodes, [&](const Point<3>& x) { return length(cross(x)); });
    const Point<3> moment = cross(grid.node_position(c));
    held = held && length(moment) > 1e-9 * length(edge) * length(edge);
    fix(c, largest_component(moment));
  }
  if (!held)
    throw InputError("/build_plate: the plate's nodes leave a rigid motion of the released part free");
  return fixed;
}

/// Takes the least-squares rigid motion of the plate's nodes out of `displacement`.
template <int Dim>
void remove_rigid_motion(const Grid<Dim>& grid, const std::vector<int>& nodes,
                         std::vector<double>& displacement) {
  constexpr int modes = Dim + rotation_count<Dim>;
  std::vector<double> center(Dim + 1, 0.0);
  for (const int node : nodes) {
    const Point<Dim> x = grid.node_position(grid.owned_nodes().index(node));
    for (int axis = 0; axis < Dim; ++axis) center[axis] += x[axis];
    center[Dim] += 1.0;
  }
  sum_in_place(grid.comm(), center);
  const auto mode = [&](const Index<Dim>& node, int k) {
    Point<Dim> x = grid.node_position(node);
    for (int axis = 0; axis < Dim; ++axis) x[axis] -= center[axis] / center[Dim];
    Point<Dim> translation{};
    if (k < Dim) translation[k] = 1.0;
    return k < Dim ? translation : rotated<Dim>(x, k - Dim);
  };
  std::vector<double> normal(modes * modes + modes, 0.0);  // R^T R, then R^T v
  for (const int node : nodes) {
    const Index<Dim> index = grid.owned_nodes().index(node);
    for (int k = 0; k < modes; ++k) {
      const Point<Dim> r = mode(index, k);
      for (int axis = 0; axis < Dim; ++axis) {
        normal[modes * modes + k] += r[axis] * displacement[static_cast<std::size_t>(node) * Dim + axis];
        for (int l = 0; l < modes; ++l) normal[k * modes + l] += r[axis] * mode(index, l)[axis];
      }
    }
  }
  sum_in_place(grid.comm(), normal);
  const int one = 1, size = modes;
  int info = 0;
  dposv_("L", &size, &one, normal.data(), &size, normal.data() + modes * modes, &size, &info);
  if (info != 0)
    throw InputError("/build_plate: the plate's nodes leave a rigid motion of the released part free");
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    for (int k = 0; k < modes; ++k)
      for (int axis = 0; axis < Dim; ++axis)
        displacement[offset * Dim + axis] -= normal[modes * modes + k] * mode(node, k)[axis];
  });
}

}  // namespace

template <int Dim>
std::vector<double> release_displacement(const ProcessSimulation<Dim>& simulation,
                                         const LayerDensities& densities,
                                         const AssembledSolverSettings& solver) {
  const ElasticModel<Dim>& model = simulation.model();
  const Grid<Dim>& grid = model.part.grid();
  const std::vector<int> nodes = plate_nodes(model);
  SystemDomain domain = model.domain;
  domain.fixed = statically_determinate_supports(grid, nodes);
  const auto numbering = std::make_shared<UnknownNumbering<Dim>>(grid, domain);
  AssembledSystem<Dim> system(domain, numbering, solver);
  std::vector<double> stiffness(domain.first_corners.size(), model.settings.min_stiffness);
  const auto& finished = densities.stage.back();
  for (std::size_t e = 0; e < finished.size(); ++e)
    stiffness[model.part_position[e]] = model.stiffness(finished[e]);
  system.assemble({{model.element.stiffness(), stiffness}});

  std::vector<double> load = plate_reactions(simulation, densities);
  for (double& force : load) force = -force;
  std::vector<double> displacement(load.size());
  const SolveReport report = system.solve(load, displacement);
  if (!report.converged) {
    std::ostringstream text;
    text << "the release solve did not converge: " << report.iterations << " iterations, residual "
         << report.residual << " (" << report.reason << ')';
    throw NumericalError(text.str());
  }
  remove_rigid_motion(grid, nodes, displacement);
  // Nodes outside the model moved with the rigid motion only: they are not there.
  std::vector<char> in_model(static_cast<std::size_t>(grid.owned_nodes().count()), 0);
  for (const int node : model_nodes(model)) in_model[node] = 1;
  for (std::size_t i = 0; i < displacement.size(); ++i)
    if (in_model[i / Dim] == 0) displacement[i] = 0.0;
  return displacement;
}

template std::vector<double> release_displacement<2>(const ProcessSimulation<2>&, const LayerDensities&,
                                                     const AssembledSolverSettings&);
template std::vector<double> release_displacement<3>(const ProcessSimulation<3>&, const LayerDensities&,
                                                     const AssembledSolverSettings&);

}  // namespace fabseq
