// SPDX-License-Identifier: MIT
#include "tasks/write_design.h"

#include "fabseq/files/hdf5_writer.h"
#include "fabseq/output/records.h"

#include <vector>

namespace fabseq {

template <int Dim>
void write_design(const Setup<Dim>& setup, const Design& design, const std::string& path) {
  const DesignSupport<Dim>& support = setup.design_support;
  const std::vector<double> field = setup.design_field(design.field);
  Hdf5Writer file(setup.world(), path);
  file.template write_field<Dim>(setup.grid, {"design", support.on_nodes(), support.components(), field});
  write_layer_variables(file, setup.layers->variables(), "", design);
  file.close();
}

FABSEQ_INSTANTIATE_FUNCTION(write_design);

}  // namespace fabseq
