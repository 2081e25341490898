// SPDX-License-Identifier: MIT
#include "fabseq/process/built_strain.h"

#include "fabseq/grid/index_box.h"

namespace fabseq {

template <int Dim>
BuiltStrain strain_when_built(const StrainSource<Dim>& strains, std::span<const double> layer) {
  constexpr std::size_t components = voigt_size<Dim>;
  const bool uniform = strains.variation() == StrainVariation::none;
  const std::size_t count = uniform ? 1 : layer.size();
  BuiltStrain result{uniform, std::vector<double>(count * components)};
  for (std::size_t e = 0; e < count; ++e) {
    const int element = static_cast<int>(e), step = uniform ? 0 : static_cast<int>(layer[e]) - 1;
    strains.set_strains({&element, 1}, {step, 1},
                        std::span(result.values).subspan(e * components, components));
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(strain_when_built);

}  // namespace fabseq
