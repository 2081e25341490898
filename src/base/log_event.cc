// SPDX-License-Identifier: MIT
#include "fabseq/base/log_event.h"

namespace fabseq {

void register_log_events() {
  for (const char* name : {"fabseq heat lanes", "fabseq lane set-up", "fabseq loads", "fabseq lane solve",
                           "fabseq derivatives", "fabseq set-up", "fabseq solve", "fabseq block solve"})
    (void)LogEvent(name);
}

}  // namespace fabseq
