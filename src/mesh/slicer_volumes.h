// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

class ZipArchive;

/// What a slicer takes a volume of an object for.
struct VolumeUse {
  enum Kind { body, negative, helper };
  Kind kind = body;
  std::string name = {}, several = {};  ///< of a helper, and of several, such as "support blockers"
};

/// What slicers of the PrusaSlicer family say, in files of their own, of the volumes of objects.
struct SlicerVolumes {
  /// A volume as a range of an object's triangles, as PrusaSlicer and SuperSlicer write it.
  struct Range {
    std::int64_t first = 0, last = 0;
    VolumeUse use;
  };
  /// A volume as a component of an object, as OrcaSlicer and Bambu Studio write it.
  struct Part {
    std::string object;  ///< number of the component's object
    VolumeUse use;
  };

  std::map<std::string, std::vector<Range>> ranges;  ///< by the number of the object
  std::map<std::string, std::vector<Part>> parts;    ///< likewise
};

/// Reads what there is of it in an archive. Throws InputError for what is damaged.
SlicerVolumes read_slicer_volumes(const ZipArchive& archive);

}  // namespace fabseq
