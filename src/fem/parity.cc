// SPDX-License-Identifier: MIT
#include "fabseq/fem/parity.h"

#include "fabseq/base/blas.h"
#include "fabseq/base/error.h"

#include <bit>
#include <vector>

namespace fabseq {

template <int Dim, int Components>
ParityMatrix<Dim, Components>::ParityMatrix(const SquareMatrix<unknowns>& matrix) {
  const auto sign = [](int mode, int corner) {
    return std::popcount(static_cast<unsigned>(mode & corner)) % 2 == 0 ? 1.0 : -1.0;
  };
  constexpr double scale = 1.0 / (classes * classes);
  for (int a = 0; a < Components; ++a)
    for (int b = 0; b < Components; ++b)
      for (int n = 0; n < classes; ++n)
        for (int m = 0; m < classes; ++m) {
          const double entry = matrix[(n * Components + a) * unknowns + m * Components + b];
          for (int r = 0; r < classes; ++r)
            blocks[r][a][b] += scale * sign(mode(r, a), n) * sign(mode(r, b), m) * entry;
        }
}

double scaled_spectrum_bound(std::span<const double> matrix, int corners, int components) {
  const int size = corners * components;
  std::vector<double> stiffness(matrix.begin(), matrix.end());
  std::vector<double> scaling(stiffness.size(), 0.0);
  for (int corner = 0; corner < corners; ++corner)
    for (int a = 0; a < components; ++a)
      for (int b = 0; b < components; ++b) {
        const int entry = (corner * components + a) * size + corner * components + b;
        scaling[entry] = stiffness[entry];
      }
  std::vector<double> eigenvalues(size), work(static_cast<std::size_t>(size) * 34);
  const int kind = 1;
  const auto work_size = static_cast<int>(work.size());
  int info = 0;
  dsygv_(&kind, "N", "U", &size, stiffness.data(), &size, scaling.data(), &size, eigenvalues.data(),
         work.data(), &work_size, &info);
  if (info != 0) throw NumericalError("the element matrix has no positive definite corner blocks");
  return eigenvalues.back();
}

template struct ParityMatrix<2, 1>;
template struct ParityMatrix<2, 2>;
template struct ParityMatrix<3, 1>;
template struct ParityMatrix<3, 3>;

}  // namespace fabseq
