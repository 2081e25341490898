// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace fabseq {

/// A 3MF file as lib3mf is to get it, and what lib3mf does not say of it.
struct ThreeMfPackage {
  /// The archive. Slicers leave out relations between the files in which the objects of a model stand
  /// (production extension), without which lib3mf does not find them: they are there.
  std::string bytes;
  std::vector<bool> printable;  ///< of the items of the build, in their order
};

/// Looks through an archive's models. Errors are InputError: for what is damaged, for a triangle with a
/// corner that is no vertex, for a model that names a file that is not there.
ThreeMfPackage prepare_three_mf(std::string bytes);

}  // namespace fabseq
