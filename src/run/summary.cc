// SPDX-License-Identifier: MIT
#include "fabseq/run/summary.h"

#include "fabseq/run/layer_variable_output.h"

namespace fabseq {

Json to_record(const Summary& summary) {
  Json record = Json::object({{"name", summary.name},
                              {"status", summary.end.status},
                              {"reason", summary.end.reason},
                              {"iterations", summary.end.iterations},
                              {"ranks", summary.ranks},
                              {"layer_groups", summary.layer_groups},
                              {"part_elements", summary.part_elements},
                              {"seconds", seconds_record(summary.seconds)},
                              {"peak_memory_bytes", summary.peak_memory_bytes}});
  if (summary.coarse_iterations > 0) record["coarse_iterations"] = summary.coarse_iterations;
  if (const auto& finish = summary.finish) {
    record["best_iteration"] = finish->best.iteration();
    record["feasible"] = finish->best.feasible();
    record["beta"] = finish->best.beta();
    record["worst_constraint"] = finish->best.worst_constraint();
    record["optimized"] = to_record(finish->optimized);
    record["binary"] = to_record(finish->binary);
  }
  if (summary.baseline != nullptr) record["baseline"] = to_record(*summary.baseline);
  if (const auto& finish = summary.finish) {
    record["interior_minima"] = finish->interior_minima;
    set_layer_variables(record, finish->layer_variables, finish->best.design());
  }
  return record;
}

}  // namespace fabseq
