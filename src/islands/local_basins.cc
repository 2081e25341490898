// SPDX-License-Identifier: MIT
#include "islands/local_basins.h"

#include "fabseq/grid/box_gather.h"
#include "islands/disjoint_sets.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace fabseq {

template <int Dim>
LocalBasins<Dim>::LocalBasins(const Field& field, const IslandLimits& limits, int rank)
    : field_(field),
      limits_(limits),
      ring_(ringed(field.owned)),
      first_id_(static_cast<std::int64_t>(rank) << 32),
      of_element_(static_cast<std::size_t>(field.owned.count()), -1) {
  std::int64_t stride = 1, owned_stride = 1;
  for (int axis = 0; axis < Dim; ++axis) {
    to_face_[2 * axis] = -stride;
    to_face_[2 * axis + 1] = stride;
    to_owned_face_[2 * axis] = -owned_stride;
    to_owned_face_[2 * axis + 1] = owned_stride;
    stride *= ring_.size[axis];
    owned_stride *= field.owned.size[axis];
  }
  find_core();
  find_order();
  for (const std::int64_t offset : order_) let_rise(element(offset));
}

template <int Dim>
typename LocalBasins<Dim>::Element LocalBasins<Dim>::element(std::int64_t owned) const {
  const Index<Dim> index = field_.owned.index(owned);
  return {index, owned, ring_.offset(index)};
}

template <int Dim>
template <class Function>
void LocalBasins<Dim>::for_each_risen(Function&& f) const {
  if (field_.owned.count() == 0) return;
  IndexBox<Dim> lines = field_.owned;
  lines.size[0] = 1;
  lines.for_each([&](const Index<Dim>& start, std::int64_t line) {
    Element element{start, line * field_.owned.size[0], ring_.offset(start)};
    for (int i = 0; i < field_.owned.size[0]; ++i, ++element.index[0], ++element.owned, ++element.ringed)
      if (rises(element.ringed)) f(element);
  });
}

template <int Dim>
RiseOrder LocalBasins<Dim>::turn_of(const Element& element) const {
  return RiseOrder::of(stiffness_at(element.ringed), field_.whole.offset(element.index));
}

template <int Dim>
template <class Function>
void LocalBasins<Dim>::for_earlier(const Element& element, Function&& f) const {
  const std::int64_t depth = RiseOrder::depth_of(stiffness_at(element.ringed));
  for (int face = 0; face < faces; ++face) {
    const int axis = face / 2;
    const std::int64_t neighbor = element.ringed + to_face_[face];
    if (!rises(neighbor)) continue;
    // Of the same depth, those below come first.
    const std::int64_t its_depth = RiseOrder::depth_of(stiffness_at(neighbor));
    if (face % 2 == 0 ? its_depth > depth : its_depth >= depth) continue;
    const int place = element.index[axis] - field_.owned.start[axis];
    f(face, neighbor, face % 2 == 0 ? place > 0 : place + 1 < field_.owned.size[axis]);
  }
}

template <int Dim>
int LocalBasins<Dim>::append_basin() {
  const int number = static_cast<int>(basins_.size());
  basins_.emplace_back().id = first_id_ + number;
  meets_others_.push_back(0);
  return number;
}

/// `alone`: whether none of its neighbours has risen.
template <int Dim>
void LocalBasins<Dim>::add(const Element& element, int basin, bool alone) {
  of_element_[element.owned] = basin;
  basins_[basin].add(turn_of(element), field_.supported[element.owned] != 0);
  if (alone) basins_[basin].peak = std::max(basins_[basin].peak, stiffness_at(element.ringed));
  for (int face = 0; face < faces; ++face) {
    const int place = element.index[face / 2] - field_.owned.start[face / 2];
    if (place == (face % 2 == 0 ? 0 : field_.owned.size[face / 2] - 1) &&
        rises(element.ringed + to_face_[face]))
      meets_others_[basin] = 1;
  }
}

template <int Dim>
void LocalBasins<Dim>::find_core() {
  DisjointSets sets;
  for_each_risen([&](const Element& element) {
    if (!in_core(stiffness_at(element.ringed))) return;
    int& set = of_element_[element.owned];
    for (int face = 0; face < faces; face += 2) {
      if (element.index[face / 2] == field_.owned.start[face / 2]) continue;
      const int below = of_element_[element.owned + to_owned_face_[face]];
      if (below < 0) continue;
      if (set < 0)
        set = below;
      else
        sets.join(set, below);
    }
    if (set >= 0) return;
    set = sets.size();
    sets.append();
  });
  std::vector<int> basin_of_set(static_cast<std::size_t>(sets.size()), -1);
  for_each_risen([&](const Element& element) {
    const int set = of_element_[element.owned];
    if (set < 0) return;
    int& basin = basin_of_set[sets.find(set)];
    if (basin < 0) basin = append_basin();
    bool alone = true;
    for_earlier(element, [&](int, std::int64_t, bool) { alone = false; });
    add(element, basin, alone);
  });
}

/// Elements outside the core, sorted by depth: within a depth they stay as they are.
template <int Dim>
void LocalBasins<Dim>::find_order() {
  std::vector<std::int64_t> starts(RiseOrder::depths + 1, 0);
  const auto key = [&](const Element& element) {
    return RiseOrder::depths + RiseOrder::depth_of(stiffness_at(element.ringed));
  };
  const auto for_each = [&](auto&& f) {
    for_each_risen([&](const Element& element) {
      if (!in_core(stiffness_at(element.ringed))) f(element);
    });
  };
  for_each([&](const Element& element) { ++starts[key(element)]; });
  std::int64_t next = 0;
  for (std::int64_t& start : starts) next += std::exchange(start, next);
  order_.resize(static_cast<std::size_t>(next));
  for_each([&](const Element& element) { order_[starts[key(element)]++] = element.owned; });
}

template <int Dim>
void LocalBasins<Dim>::let_rise(const Element& element) {
  double stiffest = -1.0;
  int basin = -1;
  for_earlier(element, [&](int face, std::int64_t neighbor, bool is_owned) {
    if (!(stiffness_at(neighbor) > stiffest)) return;
    stiffest = stiffness_at(neighbor);
    basin = is_owned ? of_element_[element.owned + to_owned_face_[face]] : -1;
  });
  add(element, basin < 0 ? append_basin() : basin, stiffest < 0.0);
}

/// What two basins are joined by when they are in one component already joins nothing, on other ranks
/// neither.
template <int Dim>
std::vector<Saddle> LocalBasins<Dim>::saddles(std::span<const std::int64_t> ids) const {
  DisjointSets components(basins_.size());
  std::unordered_map<std::int64_t, int> others;  // basins of other ranks: numbers behind those of this one
  std::vector<Saddle> result;
  const auto meet = [&](const Element& element, int basin, int face, bool is_owned, Saddle saddle) {
    int neighbor = 0;
    if (is_owned) {
      neighbor = of_element_[element.owned + to_owned_face_[face]];
      saddle.neighbor = basins_[neighbor].id;
    } else {
      saddle.neighbor = ids[element.ringed + to_face_[face]];
      const auto [found, is_new] = others.try_emplace(saddle.neighbor, components.size());
      if (is_new) components.append();
      neighbor = found->second;
    }
    saddle.basin = basins_[basin].id;
    if (components.join(neighbor, basin)) result.push_back(saddle);
  };
  for_each_risen([&](const Element& element) {
    if (!in_core(stiffness_at(element.ringed))) return;
    for_earlier(element, [&](int face, std::int64_t, bool is_owned) {
      if (!is_owned)
        meet(element, of_element_[element.owned], face, false, {RiseOrder::earliest(), Saddle::core});
    });
  });
  for (const std::int64_t offset : order_) {
    const Element element = this->element(offset);
    const int basin = of_element_[offset];
    int stiffest = -1;
    double most = -1.0;
    for_earlier(element, [&](int face, std::int64_t neighbor, bool) {
      if (stiffness_at(neighbor) > most) stiffest = face;
      most = std::max(most, stiffness_at(neighbor));
    });
    Saddle saddle{turn_of(element), Saddle::link, stiffness_at(element.ringed)};
    for_earlier(element, [&](int face, std::int64_t, bool is_owned) {
      if (face == stiffest) meet(element, basin, face, is_owned, saddle);
    });
    for_earlier(element, [&](int face, std::int64_t, bool is_owned) {
      saddle.kind = face;
      if (face != stiffest) meet(element, basin, face, is_owned, saddle);
    });
  }
  return result;
}

template <int Dim>
std::vector<int> LocalBasins<Dim>::candidates(const std::vector<Saddle>& saddles) const {
  std::vector<char> meets = meets_others_;
  for (const Saddle& saddle : saddles)
    for (const std::int64_t number : {saddle.basin - first_id_, saddle.neighbor - first_id_})
      if (number >= 0 && number < static_cast<std::int64_t>(meets.size())) meets[number] = 1;
  std::vector<int> result, alone;
  for (int basin = 0; basin < static_cast<int>(basins_.size()); ++basin)
    if (meets[basin] != 0)
      result.push_back(basin);
    else if (limits_.is_island(basins_[basin]))
      alone.push_back(basin);
  if (static_cast<int>(alone.size()) > limits_.most) {
    std::nth_element(alone.begin(), alone.begin() + limits_.most, alone.end(),
                     [&](int a, int b) { return IslandLimits::precedes(basins_[a], basins_[b]); });
    alone.resize(static_cast<std::size_t>(limits_.most));
  }
  result.insert(result.end(), alone.begin(), alone.end());
  return result;
}

FABSEQ_INSTANTIATE_CLASS(LocalBasins);

}  // namespace fabseq
