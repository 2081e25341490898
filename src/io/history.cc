#include "fabseq/io/history.h"

namespace fabseq {

void History::append(const Json& entry) const { directory_.append_line("history.jsonl", entry.dump()); }

}  // namespace fabseq
