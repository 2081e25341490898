// SPDX-License-Identifier: MIT
#include "fabseq/report/build_fields.h"

#include <algorithm>

namespace fabseq {

const std::vector<double>* BuildFields::find(const std::string& name) const {
  const auto field = std::find_if(fields_.begin(), fields_.end(),
                                  [&](const BuildField& other) { return other.name == name; });
  return field == fields_.end() ? nullptr : &field->values;
}

void BuildFields::keep_binary() {
  std::erase_if(fields_, [](const BuildField& field) { return !field.with_binary; });
}

template <int Dim>
void add_build_fields(FieldSet<Dim>& fields, const Part<Dim>& part, const BuildFields& build,
                      const std::string& prefix) {
  for (const BuildField& field : build.all())
    fields.add_elements(prefix + field.name, field.values, field.components, &part.elements());
}

FABSEQ_INSTANTIATE_FUNCTION(add_build_fields);

}  // namespace fabseq
