// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/field_set.h"
#include "fabseq/part/part.h"

#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// A field that a finding's figures are taken from, on the owned elements of the part.
struct BuildField {
  std::string name;            ///< of its dataset
  std::vector<double> values;  ///< [element][component]
  int components = 1;
  bool with_binary =
      false;  ///< result.h5 has it of smooth layers, and of the binary ones in the group binary
};

/// The fields of a sequence's findings, in the order in which these measure. Fields that are not defined are
/// missing on all ranks alike.
class BuildFields {
 public:
  void add(BuildField field) { fields_.push_back(std::move(field)); }
  const std::vector<BuildField>& all() const { return fields_; }
  /// Values of the field of that name; nullptr if there is none.
  const std::vector<double>* find(const std::string& name) const;
  /// Leaves what result.h5 has of binary layers.
  void keep_binary();

 private:
  std::vector<BuildField> fields_;
};

/// Adds all of them to a set, names prefixed. They and the part must outlive it.
template <int Dim>
void add_build_fields(FieldSet<Dim>& fields, const Part<Dim>& part, const BuildFields& build,
                      const std::string& prefix);

}  // namespace fabseq
