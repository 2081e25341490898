// SPDX-License-Identifier: MIT
#include "base/core_count.h"

#include <hwloc.h>

namespace fabseq {

namespace {

/// Sole owner of what hwloc finds: cores and threads only. It asks no devices, for which its plug-ins would
/// talk to screens and drivers, and leaves the process on the threads where it runs.
class Topology {
 public:
  Topology() {
    if (hwloc_topology_init(&found_) != 0) return;
    hwloc_topology_set_all_types_filter(found_, HWLOC_TYPE_FILTER_KEEP_NONE);
    hwloc_topology_set_type_filter(found_, HWLOC_OBJ_CORE, HWLOC_TYPE_FILTER_KEEP_ALL);
    // Which threads count is the caller's to say: other ranks may run where this one may not.
    hwloc_topology_set_flags(
        found_, HWLOC_TOPOLOGY_FLAG_INCLUDE_DISALLOWED | HWLOC_TOPOLOGY_FLAG_DONT_CHANGE_BINDING);
    loaded_ = hwloc_topology_load(found_) == 0;
  }
  Topology(Topology&&) = delete;
  ~Topology() {
    if (found_ != nullptr) hwloc_topology_destroy(found_);
  }

  bool loaded() const { return loaded_; }
  hwloc_topology_t get() const { return found_; }

 private:
  hwloc_topology_t found_ = nullptr;
  bool loaded_ = false;
};

/// Sole owner of hwloc's copy of a set of threads.
class Bitmap {
 public:
  explicit Bitmap(const ThreadSet& threads) : bits_(hwloc_bitmap_alloc()) {
    if (bits_ == nullptr) return;
    const auto words = threads.words();
    hwloc_bitmap_from_ulongs(bits_, static_cast<unsigned>(words.size()), words.data());
  }
  Bitmap(Bitmap&&) = delete;
  ~Bitmap() { hwloc_bitmap_free(bits_); }

  hwloc_bitmap_t get() const { return bits_; }

 private:
  hwloc_bitmap_t bits_;
};

}  // namespace

CoreCount count_cores(const ThreadSet& threads) {
  const CoreCount each_a_core{threads.count(), threads.count()};
  const Topology topology;
  const Bitmap own(threads);
  if (!topology.loaded() || own.get() == nullptr) return each_a_core;
  CoreCount result;
  for (hwloc_obj_t core = nullptr;
       (core = hwloc_get_next_obj_by_type(topology.get(), HWLOC_OBJ_CORE, core)) != nullptr;)
    result.cores += hwloc_bitmap_intersects(core->cpuset, own.get()) != 0 ? 1 : 0;
  hwloc_bitmap_and(own.get(), own.get(), hwloc_topology_get_topology_cpuset(topology.get()));
  result.threads = hwloc_bitmap_weight(own.get());
  return result.cores > 0 ? result : each_a_core;
}

}  // namespace fabseq
