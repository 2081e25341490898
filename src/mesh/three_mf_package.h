// SPDX-License-Identifier: MIT
#pragma once

#include "mesh/slicer_volumes.h"
#include "mesh/three_mf_contents.h"

#include <string>

namespace fabseq {

/// A 3MF file as lib3mf is to get it, and what lib3mf does not say of it.
struct ThreeMfPackage {
  /// The archive. Slicers leave out relations between the files in which the objects of a model stand
  /// (production extension), without which lib3mf does not find them: they are there. Others name what is not
  /// there, such as a picture, which lib3mf refuses: they are gone.
  std::string bytes;
  std::string root;  ///< the file with the build
  ThreeMfContents contents;
  SlicerVolumes volumes;
};

/// Looks through an archive. Throws what read_three_mf_contents() and read_slicer_volumes() throw.
ThreeMfPackage prepare_three_mf(std::string bytes);

}  // namespace fabseq
