// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/parity.h"
#include "kernels/lanes.h"

#include <array>
#include <cstddef>

namespace fabseq {

/// The displacement of an H8 element as the plastic process needs it (docs/formulation.md 16): six mean
/// strains, and twelve amplitudes of modes without mean strain (hourglass modes), [component]: 18 numbers.
/// All else is rigid motion. Several systems at once.
class ElementModes {
 public:
  static constexpr int strains = 6, amplitudes = 12, components = strains + amplitudes;
  static constexpr int unknowns = 24;
  template <int Width>
  using Nodal = std::array<std::array<Lanes<Width>, 8>, 3>;  ///< [component][corner]
  template <int Width>
  using Modes = std::array<Lanes<Width>, components>;

  explicit ElementModes(const ElementMatrices<3>& element, const Point<3>& spacing);

  /// Strains and amplitudes of nodal displacements, which are used up.
  template <int Width>
  Modes<Width> of(Nodal<Width>& u) const;
  /// Nodal forces of stresses that are the same in the element, [Voigt], and of amplitudes with the element's
  /// stiffness in these modes, both for unit Young's modulus.
  template <int Width>
  Nodal<Width> forces(const Modes<Width>& modes) const;
  /// Product of amplitudes with the element's stiffness between them, for unit Young's modulus.
  template <int Width>
  Lanes<Width> energy(const std::array<Lanes<Width>, amplitudes>& a,
                      const std::array<Lanes<Width>, amplitudes>& b) const;
  double volume() const { return volume_; }

 private:
  static constexpr std::array<int, 4> hourglass = {3, 5, 6, 7};  ///< parity modes of a component
  /// Number of an amplitude: parity mode, one of `hourglass`, of a component.
  static constexpr int amplitude(int mode, int component) {
    return strains + 3 * (mode == 3 ? 0 : mode - 4) + component;
  }
  template <int Width>
  static void transform(Nodal<Width>& values);

  ParityMatrix<3, 3> stiffness_;
  std::array<double, 3> slope_;  ///< strain of the mode that is odd along an axis alone, 1/length
  double volume_;
};

template <int Width>
void ElementModes::transform(Nodal<Width>& values) {
  for (auto& component : values)
    for (int step = 1; step < 8; step *= 2)
      for (int n = 0; n < 8; ++n)
        if ((n & step) == 0) {
          const auto lower = component[n], upper = component[n + step];
          component[n] = lower + upper;
          component[n + step] = lower - upper;
        }
}

template <int Width>
ElementModes::Modes<Width> ElementModes::of(Nodal<Width>& u) const {
  transform<Width>(u);
  const auto gradient = [&](int component, int axis) { return u[component][1 << axis] * slope_[axis]; };
  Modes<Width> result;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    result[a] = gradient(a, a);
    result[3 + a] = gradient(a, b) + gradient(b, a);
  }
  for (const int mode : hourglass)
    for (int a = 0; a < 3; ++a) result[amplitude(mode, a)] = u[a][mode];
  return result;
}

template <int Width>
Lanes<Width> ElementModes::energy(const std::array<Lanes<Width>, amplitudes>& a,
                                  const std::array<Lanes<Width>, amplitudes>& b) const {
  Lanes<Width> result = Lanes<Width>::zero();
  for (int parity_class = 0; parity_class < 8; ++parity_class)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int row = ParityMatrix<3, 3>::mode(parity_class, i),
                  column = ParityMatrix<3, 3>::mode(parity_class, j);
        if (row < 3 || row == 4 || !ParityMatrix<3, 3>::couples(parity_class, i, j)) continue;
        result += a[amplitude(row, i) - strains] * b[amplitude(column, j) - strains] *
                  stiffness_.blocks[parity_class][i][j];
      }
  return result;
}

template <int Width>
ElementModes::Nodal<Width> ElementModes::forces(const Modes<Width>& modes) const {
  Nodal<Width> result;
  for (auto& component : result) component.fill(Lanes<Width>::zero());
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    result[a][1 << a] += modes[a] * (volume_ * slope_[a]);
    result[a][1 << b] += modes[3 + a] * (volume_ * slope_[b]);
    result[b][1 << a] += modes[3 + a] * (volume_ * slope_[a]);
  }
  for (int parity_class = 0; parity_class < 8; ++parity_class)
    for (int a = 0; a < 3; ++a) {
      const int row = ParityMatrix<3, 3>::mode(parity_class, a);
      if (row < 3 || row == 4) continue;
      for (int b = 0; b < 3; ++b) {
        const int column = ParityMatrix<3, 3>::mode(parity_class, b);
        if (ParityMatrix<3, 3>::couples(parity_class, a, b))
          result[a][row] += modes[amplitude(column, b)] * stiffness_.blocks[parity_class][a][b];
      }
    }
  transform<Width>(result);
  return result;
}

}  // namespace fabseq
