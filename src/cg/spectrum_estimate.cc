// SPDX-License-Identifier: MIT
#include "cg/spectrum_estimate.h"

#include <algorithm>

namespace fabseq {

void SpectrumEstimate::add(double alpha, double beta) {
  if (!(alpha > 0.0)) return;
  // A flexible method's beta may come out slightly negative; the matrix stays symmetric without it.
  const double momentum = diagonal_.empty() ? 0.0 : std::max(0.0, beta);
  if (!diagonal_.empty()) squared_off_diagonal_.push_back(momentum / (last_alpha_ * last_alpha_));
  diagonal_.push_back(1.0 / alpha + (diagonal_.empty() ? 0.0 : momentum / last_alpha_));
  last_alpha_ = alpha;
}

bool SpectrumEstimate::is_below_spectrum(double shift) const {
  double pivot = diagonal_[0] - shift;
  for (std::size_t i = 1; pivot > 0.0 && i < diagonal_.size(); ++i)
    pivot = diagonal_[i] - shift - squared_off_diagonal_[i - 1] / pivot;
  return pivot > 0.0;
}

double SpectrumEstimate::smallest() const {
  if (diagonal_.empty()) return 1.0;
  constexpr int halvings = 40;
  double low = 0.0, high = *std::min_element(diagonal_.begin(), diagonal_.end());
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (is_below_spectrum(middle) ? low : high) = middle;
  }
  return high;
}

}  // namespace fabseq
