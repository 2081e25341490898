// SPDX-License-Identifier: MIT
#include "fabseq/report/late_sets.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"
#include "fabseq/report/verdict.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace fabseq {

namespace {

/// The first layer with an element at each owned node, 0 with one of the substrate: under nominal deposition
/// the node moves from then on. Infinite without elements.
template <int Dim>
std::vector<double> own_layers(const Part<Dim>& part, std::span<const double> layer_index) {
  const Grid<Dim>& grid = part.grid();
  const ElementHalo<Dim> halo(grid, 1);
  const std::vector<double> layers = halo.gather(part.expand(layer_index, INFINITY, 0.0));
  std::vector<double> result(static_cast<std::size_t>(grid.owned_nodes().count()), INFINITY);
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    for (int number = 0; number < 1 << Dim; ++number) {
      const Index<Dim> element = stepped<Dim>(node, number, -1);
      if (halo.box().contains(element))
        result[offset] = std::min(result[offset], layers[halo.box().offset(element)]);
    }
  });
  return result;
}

}  // namespace

std::string LateSet::words() const {
  const std::string last = layers == 1 ? "last layer builds " : formatted("last %d layers build ", layers);
  return "the " + last + percent_words(share) + " of node set " + name +
         ", which moves mostly with its own layer: thinner layers make this motion small in every sequence, "
         "planar ones too, and the gain may vanish";
}

template <int Dim>
std::vector<LateSet> late_sets(const Part<Dim>& part, const std::map<std::string, NodeSet>& node_sets,
                               const std::vector<Term>& terms, std::span<const double> layer_index) {
  std::set<std::string> measured;
  for (const Term& term : terms) {
    const TermFacts facts = term.type->facts(term);
    if (!facts.measures_release) measured.insert(facts.node_sets.begin(), facts.node_sets.end());
  }
  const MPI_Comm comm = part.grid().comm();
  const double last =
      max(comm, layer_index.empty() ? 0.0 : *std::max_element(layer_index.begin(), layer_index.end()));
  const double layers = std::max(1.0, std::floor(0.1 * last));
  const std::vector<double> own = own_layers(part, layer_index);
  std::vector<LateSet> result;
  for (const std::string& name : measured) {
    const NodeSet& set = node_sets.at(name);
    const auto late = std::count_if(set.owned.begin(), set.owned.end(),
                                    [&](int node) { return own[node] > last - layers; });
    const double share =
        static_cast<double>(sum(comm, static_cast<std::int64_t>(late))) / static_cast<double>(set.count);
    if (share >= 0.5) result.push_back({name, share, static_cast<int>(layers)});
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(late_sets);

}  // namespace fabseq
