// SPDX-License-Identifier: MIT
/// \file
/// Plastic flow once more (formulation 16), one step after the other: dense matrices over the whole grid on
/// every rank, and Newton's method with the tangent that is consistent with the radial return.
#pragma once

#include "support/flow_element.h"
#include "support/small_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace fabseq::test {

/// Material of an element of the grid in a step; stresses in the material's unit.
struct FlowMaterial {
  double young = 0.0;  ///< E; 0: not in the model
  double ratio = 1.0;  ///< phi
  double yield = 0.0, hardening = 0.0;
  SixNumbers load{};  ///< l
};

struct FlowState {
  SixNumbers stress{};
  double plastic_strain = 0.0;
  FlowElement::Vector hourglass{};
};

/// The stress that a step leads to, and its derivative with respect to the mean strain.
struct RadialReturn {
  RadialReturn(const FlowElement& element, const FlowMaterial& material, const FlowState& before,
               const SixNumbers& strain) {
    SixNumbers elastic;
    for (int c = 0; c < 6; ++c) elastic[c] = material.young * strain[c] - material.load[c];
    stress = element.stress(elastic);
    for (int c = 0; c < 6; ++c) stress[c] += material.ratio * before.stress[c];
    const SixNumbers d = deviator(stress);
    const double q = equivalent_stress(d), shear = material.young * element.shear;
    flow = std::max(0.0, (q - material.yield - material.hardening * before.plastic_strain) /
                             (3.0 * shear + material.hardening));
    const double share = flow > 0.0 ? 3.0 * shear * flow / q : 0.0;
    const double along =
        flow > 0.0 ? 9.0 * shear * shear / (q * q) * (1.0 / (3.0 * shear + material.hardening) - flow / q)
                   : 0.0;
    for (int j = 0; j < 6; ++j) {
      SixNumbers unit{};
      unit[j] = material.young;
      const SixNumbers column = element.stress(unit), of_shape = deviator(column);
      for (int i = 0; i < 6; ++i) tangent[i][j] = column[i] - share * of_shape[i] - along * d[i] * d[j];
    }
    for (int c = 0; c < 6; ++c) stress[c] -= share * d[c];
  }

  SixNumbers stress;
  double flow;  ///< Delta gamma
  std::array<SixNumbers, 6> tangent;
};

/// All elements of a grid on their way through the steps.
class NewtonFlow {
 public:
  /// `held`: whether the supports hold a node. Nodes are lexicographic.
  NewtonFlow(const Index<3>& elements, const FlowElement& element, std::vector<char> held)
      : element_(element), held_(std::move(held)) {
    nodes_.size = elements;
    for (int& extent : nodes_.size) ++extent;
    const IndexBox<3> all{{}, elements};
    states_.resize(all.count());
    all.for_each([&](const Index<3>& index, std::int64_t) {
      auto& numbers = unknowns_.emplace_back();
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        Index<3> node = index;
        for (int a = 0; a < 3; ++a) node[a] += static_cast<int>(i / 3) >> a & 1;
        numbers[i] = nodes_.offset(node) * 3 + i % 3;
      }
    });
  }

  /// Takes the states through a step; `released`: nothing is held. Returns the displacement that it adds,
  /// [node][component]; where nothing is held, without the mean motion of the nodes that were.
  std::vector<double> advance(const std::vector<FlowMaterial>& materials, bool released) {
    std::vector<double> displacement(3 * held_.size(), 0.0);
    decrements_.clear();
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
      std::vector<double> tangent(displacement.size() * displacement.size(), 0.0);
      const std::vector<double> forces = forces_of(materials, displacement, &tangent);
      if (released) hold_mean(tangent);
      const std::vector<double> step = solve(std::move(tangent), forces, released);
      const double slope = -along(forces, step);
      decrements_.push_back(std::sqrt(std::max(slope, 0.0)));
      largest_ = std::max(largest_, decrements_.back());
      // The forces are the derivative of a convex function: where it rises, the minimum is behind.
      double share = 1.0;
      while (share > 1e-3 &&
             along(forces_of(materials, moved(displacement, share, step)), step) > 0.5 * slope)
        share *= 0.5;
      displacement = moved(displacement, share, step);
      if (decrements_.back() <= converged * largest_) break;
    }
    EXPECT_LE(decrements_.back(), converged * largest_) << "Newton's method does not converge";
    for (std::size_t e = 0; e < states_.size(); ++e)
      if (materials[e].young > 0.0)
        states_[e] = behind(materials[e], states_[e], of_element(e, displacement));
    return displacement;
  }

  const std::vector<FlowState>& states() const { return states_; }
  /// sqrt(z . K z) of the corrections z of the last step, where K is the tangent, over the largest of all
  /// steps.
  std::vector<double> decrements() const {
    std::vector<double> result = decrements_;
    for (double& value : result) value /= largest_;
    return result;
  }

 private:
  static constexpr int most_iterations = 40;
  static constexpr double converged = 1e-12;

  FlowElement::Vector of_element(std::size_t e, const std::vector<double>& displacement) const {
    FlowElement::Vector result;
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = displacement[unknowns_[e][i]];
    return result;
  }
  FlowState behind(const FlowMaterial& material, const FlowState& before,
                   const FlowElement::Vector& u) const {
    const RadialReturn returned(element_, material, before, element_.mean(u));
    FlowState result{returned.stress, before.plastic_strain + returned.flow, element_.hourglass_force(u)};
    for (std::size_t i = 0; i < u.size(); ++i)
      result.hourglass[i] = material.young * result.hourglass[i] + material.ratio * before.hourglass[i];
    return result;
  }
  /// Forces of all steps up to one that leads to these displacements. Adds the tangent, unless it is null.
  std::vector<double> forces_of(const std::vector<FlowMaterial>& materials,
                                const std::vector<double>& displacement,
                                std::vector<double>* tangent = nullptr) const {
    std::vector<double> result(displacement.size(), 0.0);
    for (std::size_t e = 0; e < states_.size(); ++e) {
      if (materials[e].young == 0.0) continue;
      const FlowElement::Vector u = of_element(e, displacement);
      const FlowState state = behind(materials[e], states_[e], u);
      for (std::size_t i = 0; i < u.size(); ++i)
        result[unknowns_[e][i]] +=
            element_.volume * paired(element_.mean_strain[i], state.stress) + state.hourglass[i];
      if (tangent != nullptr) add_tangent(e, materials[e], u, *tangent);
    }
    return result;
  }
  void add_tangent(std::size_t e, const FlowMaterial& material, const FlowElement::Vector& u,
                   std::vector<double>& matrix) const {
    const auto tangent = RadialReturn(element_, material, states_[e], element_.mean(u)).tangent;
    for (std::size_t i = 0; i < u.size(); ++i) {
      SixNumbers of_row{};
      for (int c = 0; c < 6; ++c)
        for (int d = 0; d < 6; ++d) of_row[d] += element_.volume * element_.mean_strain[i][c] * tangent[c][d];
      for (std::size_t j = 0; j < u.size(); ++j)
        matrix[unknowns_[e][i] * held_.size() * 3 + unknowns_[e][j]] +=
            paired(of_row, element_.mean_strain[j]) + material.young * element_.hourglass[i * u.size() + j];
    }
  }
  /// Adds springs on the mean motion of the supports. Forces without resultants do not strain them.
  void hold_mean(std::vector<double>& matrix) const {
    const std::size_t size = 3 * held_.size();
    for (int motion = 0; motion < 6; ++motion) {
      std::vector<double> field(size, 0.0);
      nodes_.for_each([&](const Index<3>& node, std::int64_t number) {
        const std::size_t first = number * 3;
        if (held_[number] == 0 || matrix[first * (size + 1)] == 0.0) return;
        const int a = motion % 3, b = (a + 1) % 3, c = (a + 2) % 3;
        if (motion < 3) {
          field[first + a] = 1.0;
        } else {
          field[first + b] = -node[c] * element_.spacing[c];
          field[first + c] = node[b] * element_.spacing[b];
        }
      });
      for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < size && field[i] != 0.0; ++j)
          matrix[i * size + j] += element_.volume * field[i] * field[j];
    }
  }
  /// The correction that balances the forces; 0 where nodes are held or touch no element.
  std::vector<double> solve(std::vector<double> matrix, std::span<const double> forces, bool released) const {
    const int size = static_cast<int>(forces.size()), one = 1;
    std::vector<double> result(forces.size(), 0.0);
    for (std::size_t i = 0; i < result.size(); ++i) {
      double& diagonal = matrix[i * (result.size() + 1)];
      result[i] = -forces[i];
      if (diagonal != 0.0 && (released || held_[i / 3] == 0)) continue;
      for (std::size_t j = 0; j < result.size(); ++j)
        matrix[i * result.size() + j] = matrix[j * result.size() + i] = 0.0;
      diagonal = 1.0;
      result[i] = 0.0;
    }
    int info = 0;
    dposv_("L", &size, &one, matrix.data(), &size, result.data(), &size, &info);
    EXPECT_EQ(info, 0) << "the tangent is not positive definite";
    return result;
  }
  /// A rank has the whole grid.
  static double along(std::span<const double> a, std::span<const double> b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  }

  const FlowElement& element_;
  IndexBox<3> nodes_;
  std::vector<char> held_;
  std::vector<std::array<std::size_t, FlowElement::unknowns>> unknowns_;  ///< of each element
  std::vector<FlowState> states_;
  std::vector<double> decrements_;
  double largest_ = 0.0;
};

}  // namespace fabseq::test
