// SPDX-License-Identifier: MIT
#include "fabseq/report/finding.h"

#include <algorithm>

namespace fabseq {

namespace {

/// All findings in order. It grows during static initialization.
std::vector<const Finding*>& registered_findings() {
  static std::vector<const Finding*> all;
  return all;
}

bool comes_first(const Finding* a, const Finding* b) {
  return a->rank != b->rank ? a->rank < b->rank : a->name < b->name;
}

}  // namespace

void register_finding(const Finding* finding) {
  std::vector<const Finding*>& all = registered_findings();
  all.insert(std::upper_bound(all.begin(), all.end(), finding, comes_first), finding);
}

std::vector<const Finding*> findings() { return registered_findings(); }

template <int Dim>
void measure_findings(const MeasuredSequence<Dim>& sequence, std::initializer_list<MeasuredIn> what,
                      BuildReport& report) {
  for (const Finding* finding : registered_findings())
    if (std::ranges::find(what, finding->measured_in) != what.end()) finding->measure(sequence, report);
}

FABSEQ_INSTANTIATE_FUNCTION(measure_findings);

}  // namespace fabseq
