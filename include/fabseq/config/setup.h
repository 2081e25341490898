// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/config/config.h"
#include "fabseq/model/model.h"
#include "fabseq/sequence/sequence_kind.h"

#include <algorithm>
#include <vector>

namespace fabseq {

/// What all tasks start from: a config and the model it asks for. Collective construction on the world of the
/// run. The config must outlive it. Throws InputError for what is wrong with the model, and for a release
/// that there cannot be.
template <int Dim>
class Setup : public Model<Dim> {
 public:
  Setup(MPI_Comm world, const Config& config_);

  const Config& config;

  /// Whether layers are steps, not smooth: where that is asked for, and planar ones.
  bool binary() const { return config.projection.binary || config.sequence.kind->binary; }
  /// The config with what "auto" stands for, so that this stays when other things change. Not collective.
  Config resolved() const;
  /// The effective config with the number that the characteristic length comes to: a design means another
  /// pseudo-time with another one, whatever layers it is cut into. Not collective.
  Json effective() const;
  /// 1 on the owned elements of the substrate, as a field for files.
  std::vector<double> substrate_field() const {
    const auto& elements = this->part.substrate().elements();
    return {elements.begin(), elements.end()};
  }
  /// Throws InputError if the densities and displacements of all layers are more than the machines of this
  /// run can hold. Collective.
  void require_memory_of_layers() const;
  /// Throws InputError if an optimization takes more memory than limits of address space leave to the ranks:
  /// libraries do not survive that. Collective.
  void require_address_space() const;
  /// Refuses meshes on a grid that is too coarse for their walls. Collective on the world.
  void require_walls() const;

 private:
  /// The design's sequence and the planar baseline count.
  int most_layers_of_a_sequence() const { return std::max(this->layers->count(), this->baseline->count()); }
  void require_layers_that_fit() const;
  void require_release() const;
  void require_plate() const;
  void warn_about_method() const;
};

}  // namespace fabseq
