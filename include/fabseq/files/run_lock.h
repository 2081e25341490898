// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace fabseq {

/// Keeps a second run out of a directory. The lock belongs to the open file `lock` in it, so that it ends
/// with the process that holds it, however that ends; the file says which one it is. On file systems without
/// locks nobody is kept out. For one rank of a run; not collective.
class RunLock {
 public:
  /// Takes the lock of an existing directory. Throws InputError naming host and process of the run that holds
  /// it.
  explicit RunLock(const std::string& directory);
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  /// Removes the file and gives the lock back.
  ~RunLock();

 private:
  std::string path_;
  int descriptor_ = -1;
};

}  // namespace fabseq
