// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/grid/rigid_fit.h"
#include "islands/island_map.h"
#include "kernels/lane_array.h"
#include "multigrid/band_cholesky.h"
#include "multigrid/lane_operator.h"

#include <cmath>
#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// The islands of one lane and the energy of their motions.
template <int Dim>
struct IslandMotions {
  struct Place : LaneIslands::Node {
    Point<Dim> position{};  ///< from the island's centre
  };
  int count = 0;
  std::vector<Place> places;
  std::vector<double> scales;  ///< of the modes, for a unit diagonal
  BandCholesky energy;
};

/// Adds Z (Z^T K Z)^-1 Z^T r to a correction, Z the rigid motions of a lane's islands: motions that cost next
/// to no energy and that no coarse grid shows. In double precision: what moves an island is a billionth of
/// the forces in it. Vectors as LaneOperator's, on the finest level.
template <class Problem, int Width>
class IslandModes {
 public:
  static constexpr int dim = Problem::dim;
  static constexpr int modes = rigid_motion_count<dim>;
  static constexpr int node_values = dim * Width;
  using Operator = LaneOperator<Problem, Width>;

  /// What is known of each lane's islands, whatever the width: it can be kept.
  using Known = std::vector<std::shared_ptr<const IslandMotions<dim>>>;

  bool empty() const { return most_ == 0; }
  /// Islands of a lane.
  int count(int lane) const { return lanes_[lane] ? lanes_[lane]->count : 0; }
  Known known() const { return {lanes_.begin(), lanes_.end()}; }
  /// Takes over what known() has returned for the very same operators. Not collective.
  void take(const Known& known) {
    most_ = 0;
    for (int lane = 0; lane < Width; ++lane) {
      lanes_[lane] = known[lane];
      most_ = std::max(most_, lanes_[lane]->count);
    }
  }
  /// Collective on the level's communicator.
  void set_up(Operator& matrix, const std::vector<LaneIslands>& islands) {
    constexpr double regularization = 1e-10;
    std::array<std::shared_ptr<Lane>, Width> lanes;
    std::vector<std::vector<double>> energies;
    most_ = 0;
    for (int lane = 0; lane < Width; ++lane) {
      lanes_[lane] = lanes[lane] = locate(matrix.level(), islands[lane]);
      most_ = std::max(most_, lanes[lane]->count);
      energies.emplace_back(static_cast<std::size_t>(lanes[lane]->count) * modes * lanes[lane]->count * modes,
                            0.0);
    }
    if (empty()) return;
    measure_energy(matrix, energies);
    for (int lane = 0; lane < Width; ++lane) {
      Lane& own = *lanes[lane];
      const int size = own.count * modes;
      own.scales.assign(static_cast<std::size_t>(size), 0.0);
      for (int i = 0; i < size; ++i) {
        const double energy = energies[lane][static_cast<std::size_t>(i) * size + i];
        own.scales[i] = energy > 0.0 ? 1.0 / std::sqrt(energy) : 0.0;
      }
      own.energy.resize(size, std::max(0, size - 1));
      for (int i = 0; i < size; ++i)
        for (int j = 0; j <= i; ++j) {
          const double entry =
              energies[lane][static_cast<std::size_t>(j) * size + i] * own.scales[i] * own.scales[j];
          own.energy.add(i, j, i == j && own.scales[i] > 0.0 ? entry + regularization : entry);
        }
      // Modes that depend on each other within rounding are left out altogether.
      if (size > 0 && !own.energy.factor()) own.count = 0;
    }
  }

  template <int Wider>
  void select(const IslandModes<Problem, Wider>& from, std::span<const int> lanes) {
    most_ = 0;
    if (from.empty()) return;
    for (int lane = 0; lane < Width; ++lane) {
      lanes_[lane] = from.lanes_[selected(lanes, lane)];
      most_ = std::max(most_, lanes_[lane]->count);
    }
  }

  /// x += Z (Z^T K Z)^-1 Z^T r. `Real`: double or float. Collective.
  template <class Real>
  void add_correction(const LaneLevel<dim>& level, const double* residual, Real* x) const {
    const int stride = most_ * modes;
    std::vector<double> amplitudes(static_cast<std::size_t>(Width) * stride, 0.0);
    const auto first = [&](int lane) { return &amplitudes[static_cast<std::size_t>(lane) * stride]; };
    for (int lane = 0; lane < Width; ++lane) {
      const Lane& own = *lanes_[lane];
      for (const Place& place : own.places)
        for (int m = 0; place.counted && own.count > 0 && m < modes; ++m)
          for (int a = 0; a < dim; ++a)
            first(lane)[place.island * modes + m] += own.scales[place.island * modes + m] *
                                                     rigid_motion<dim>(m, a, place.position) *
                                                     residual[place.node * node_values + a * Width + lane];
    }
    sum_in_place(level.comm, amplitudes);
    for (int lane = 0; lane < Width; ++lane) {
      const Lane& own = *lanes_[lane];
      if (own.count == 0) continue;
      own.energy.solve({first(lane), static_cast<std::size_t>(own.count) * modes});
      for (const Place& place : own.places)
        for (int a = 0; a < dim; ++a) {
          Real& value = x[place.node * node_values + a * Width + lane];
          double sum = value;  // what the modes take away may be all but a little of it
          for (int m = 0; m < modes; ++m) {
            const int index = place.island * modes + m;
            sum += first(lane)[index] * own.scales[index] * rigid_motion<dim>(m, a, place.position);
          }
          value = static_cast<Real>(sum);
        }
    }
  }

 private:
  template <class, int>
  friend class IslandModes;

  using Lane = IslandMotions<dim>;
  using Place = typename Lane::Place;
  static std::shared_ptr<Lane> locate(const LaneLevel<dim>& level, const LaneIslands& islands) {
    auto lane = std::make_shared<Lane>();
    lane->count = islands.count;
    std::vector<double> centers(static_cast<std::size_t>(islands.count) * (dim + 1), 0.0);
    auto run = level.mesh.node_runs().begin();
    for (const auto& node : islands.nodes) {
      while (node.node >= run->node + run->length) ++run;
      Place& place = lane->places.emplace_back(Place{node, {}});
      Index<dim> index = run->index;
      index[0] += static_cast<int>(node.node - run->node);
      for (int axis = 0; axis < dim; ++axis) place.position[axis] = index[axis] * level.spacing[axis];
      if (!node.counted) continue;
      double* center = &centers[static_cast<std::size_t>(node.island) * (dim + 1)];
      for (int axis = 0; axis < dim; ++axis) center[axis] += place.position[axis];
      center[dim] += 1.0;
    }
    sum_in_place(level.comm, centers);
    for (Place& place : lane->places)
      for (int axis = 0; axis < dim; ++axis)
        place.position[axis] -= centers[static_cast<std::size_t>(place.island) * (dim + 1) + axis] /
                                centers[static_cast<std::size_t>(place.island) * (dim + 1) + dim];
    return lane;
  }

  /// Z^T K Z of every lane, one mode of one island of all lanes at a time.
  void measure_energy(Operator& matrix, std::vector<std::vector<double>>& energies) const {
    LaneArray motion(matrix.size()), force(matrix.size());
    for (int column = 0; column < most_ * modes; ++column) {
      std::fill(motion.begin(), motion.end(), 0.0);
      for (int lane = 0; lane < Width; ++lane)
        for (const Place& place : lanes_[lane]->places)
          for (int a = 0; place.island == column / modes && a < dim; ++a)
            motion[place.node * node_values + a * Width + lane] =
                rigid_motion<dim>(column % modes, a, place.position);
      matrix.apply(motion.data(), force.data());
      for (int lane = 0; lane < Width; ++lane) {
        const int size = lanes_[lane]->count * modes;
        if (column >= size) continue;
        for (const Place& place : lanes_[lane]->places)
          for (int m = 0; place.counted && m < modes; ++m)
            for (int a = 0; a < dim; ++a)
              energies[lane][static_cast<std::size_t>(column) * size + place.island * modes + m] +=
                  rigid_motion<dim>(m, a, place.position) *
                  force[place.node * node_values + a * Width + lane];
      }
    }
    for (auto& energy : energies) sum_in_place(matrix.level().comm, energy);
  }

  std::array<std::shared_ptr<const Lane>, Width> lanes_;
  int most_ = 0;  ///< islands of a lane
};

}  // namespace fabseq
