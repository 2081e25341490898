// SPDX-License-Identifier: MIT
#include "fabseq/sequence/design_support.h"

namespace fabseq {

template <int Dim>
std::vector<double> DesignSupport<Dim>::expand(std::span<const double> variables) const {
  const std::int64_t count = on_nodes_ ? grid_.owned_nodes().count() : grid_.owned_elements().count();
  std::vector<double> field(static_cast<std::size_t>(count), 0.0);
  for (std::size_t i = 0; i < places_.size(); ++i) field[places_[i]] = variables[i];
  return field;
}

template <int Dim>
std::vector<double> DesignSupport<Dim>::restrict_to_variables(std::span<const double> field) const {
  std::vector<double> variables;
  variables.reserve(places_.size());
  for (const int place : places_) variables.push_back(field[place]);
  return variables;
}

template <int Dim>
std::int64_t DesignSupport<Dim>::number(std::size_t variable) const {
  return on_nodes_ ? grid_.all_nodes().offset(grid_.owned_nodes().index(places_[variable]))
                   : grid_.all_elements().offset(grid_.owned_elements().index(places_[variable]));
}

FABSEQ_INSTANTIATE_CLASS(DesignSupport);

}  // namespace fabseq
