// SPDX-License-Identifier: MIT
#include "process/element_modes.h"

namespace fabseq {

/// The mode of an axis is the sum over lower corners less that over upper ones, of which there are four.
ElementModes::ElementModes(const ElementMatrices<3>& element, const Point<3>& spacing)
    : stiffness_(element.stiffness()),
      slope_{-0.25 / spacing[0], -0.25 / spacing[1], -0.25 / spacing[2]},
      volume_(spacing[0] * spacing[1] * spacing[2]) {}

double ElementModes::energy(const std::array<double, amplitudes>& a,
                            const std::array<double, amplitudes>& b) const {
  double result = 0.0;
  for (int parity_class = 0; parity_class < 8; ++parity_class)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int row = ParityMatrix<3, 3>::mode(parity_class, i),
                  column = ParityMatrix<3, 3>::mode(parity_class, j);
        if (row < 3 || row == 4 || !ParityMatrix<3, 3>::couples(parity_class, i, j)) continue;
        result += a[amplitude(row, i) - strains] * stiffness_.blocks[parity_class][i][j] *
                  b[amplitude(column, j) - strains];
      }
  return result;
}

}  // namespace fabseq
