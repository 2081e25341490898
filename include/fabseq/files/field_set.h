// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// Names and values of element and node fields on a grid, for any writer. The set owns neither: grid, values
/// and places must outlive it.
template <int Dim>
struct FieldSet {
  struct Field {
    std::string name;
    bool on_nodes = false;
    int components = 1;
    std::span<const double> values;            ///< [owned entity][component], lexicographic in the owned box
    bool single_precision = false;             ///< stored as 32-bit floats
    const std::vector<int>* places = nullptr;  ///< owned entities that have values, others have 0; null: all
    std::string description = {};  ///< what it is, in words, for the reader of a file; may be empty

    /// Values of all `count` owned entities; `room` holds them where some have none.
    std::span<const double> whole(std::int64_t count, std::vector<double>& room) const {
      if (places == nullptr) return values;
      room.assign(static_cast<std::size_t>(count) * components, 0.0);
      for (std::size_t i = 0; i < values.size(); ++i)
        room[static_cast<std::size_t>((*places)[i / components]) * components + i % components] = values[i];
      return room;
    }
  };

  const Grid<Dim>* grid = nullptr;
  std::vector<Field> fields;

  /// Adds a field on the nodes or elements, in double precision, with `components` values per node or
  /// element. `places`: those that have values, null: all. `description`: Field::description.
  void add(bool on_nodes, const std::string& name, std::span<const double> values, int components = 1,
           const std::vector<int>* places = nullptr, const std::string& description = {}) {
    fields.push_back({name, on_nodes, components, values, false, places, description});
  }
  void add_elements(const std::string& name, std::span<const double> values, int components = 1,
                    const std::vector<int>* places = nullptr) {
    add(false, name, values, components, places);
  }
  void add_nodes(const std::string& name, std::span<const double> values, int components = 1,
                 const std::vector<int>* places = nullptr, const std::string& description = {}) {
    add(true, name, values, components, places, description);
  }
};

}  // namespace fabseq
