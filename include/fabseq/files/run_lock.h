// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/posix_file.h"
#include "fabseq/files/heartbeat.h"
#include "fabseq/files/process_mark.h"

#include <memory>
#include <optional>
#include <string>

namespace fabseq {

/// Keeps a second run out of a directory. The lock belongs to the open file `lock` in it, so that it ends
/// with the process that holds it, however that ends; the file says which process it is (ProcessMark).
///
/// On file systems that lock by neither flock() nor fcntl(), the file itself counts. A process of this
/// machine that it names keeps others out while it lives. One that cannot be seen from here keeps them out
/// while it touches the file (Heartbeat), which is watched for some seconds. If nothing happens, its lock is
/// taken over with a warning: a run that was killed must not keep the next one out for ever. Where locks are
/// taken but may be those of this machine only, a file that another machine has left is taken over with a
/// warning, too.
///
/// For one rank of a run; not collective.
class RunLock {
 public:
  /// Takes the lock of an existing directory. Throws InputError naming host and process of the run that holds
  /// it.
  explicit RunLock(const std::string& directory, Pulse pulse = {});
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  /// Removes the file and gives the lock back.
  ~RunLock();

 private:
  /// Returns false if the file that was there has been removed meanwhile.
  bool take(const std::string& directory);

  std::string path_;
  Pulse pulse_;
  ProcessMark mark_ = ProcessMark::own();
  std::unique_ptr<const PosixFile> file_;  ///< none if it cannot be opened
  std::optional<Heartbeat> heartbeat_;     ///< where the file system has no locks
};

}  // namespace fabseq
