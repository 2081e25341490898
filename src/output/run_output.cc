// SPDX-License-Identifier: MIT
#include "fabseq/output/run_output.h"

#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/session.h"
#include "fabseq/files/history.h"
#include "fabseq/machine/interior_extrema.h"
#include "fabseq/output/task_directory.h"
#include "fabseq/responses/response_type.h"

#include <utility>

namespace fabseq {

namespace {

constexpr const char* starts_file = "starts.json";

}  // namespace

template <int Dim>
RunOutput<Dim>::RunOutput(const Setup<Dim>& setup, const CommandLine& command_line, const RunPlace& place,
                          const std::optional<Restart>& restart, PhaseTimer& timer)
    : setup_(setup),
      timer_(timer),
      directory_(make_run_directory(setup, command_line, place, restart && restart->in_place)),
      // Each layer group looks for itself: those that are still at work then leave it, too.
      stop_file_(setup.groups.domain(), directory_.file("stop")),
      clock_(timer),
      checkpoints_(setup, directory_, clock_, timer),
      terminal_(setup.world(), setup.config.optimizer.max_iterations) {
  if (!restart) return;
  checkpoints_.continue_from(*restart);
  continue_starts(restart->directory);
}

template <int Dim>
void RunOutput<Dim>::set_starts(const Json& record) {
  if (record.is_null()) return;
  starts_ = record;
  directory_.write(starts_file, to_text(record, 2) + "\n");
}

template <int Dim>
void RunOutput<Dim>::continue_starts(const std::string& directory) {
  const MPI_Comm comm = setup_.world();
  const std::string path = directory + "/" + starts_file;
  const std::string text = broadcast(comm, rank_of(comm) == 0 ? read_file_if_there(path) : "");
  if (!text.empty()) set_starts(parse_json(text, path));
}

template <int Dim>
void RunOutput<Dim>::baseline(SequenceReport report, const std::string& solver) {
  baseline_ = std::move(report);
  print(solver);
  if (!setup_.group_choice.explanation.empty()) print(setup_.group_choice.explanation);
  terminal_.baseline(*baseline_);
  clock_.begin_iterations();
}

template <int Dim>
void RunOutput<Dim>::iteration(const Iterate& iterate, const StepReport& step, Pipeline<Dim>& pipeline,
                               const StageResults<Dim>& state, const Design& design) {
  {
    const auto scope = timer_.enter(Phase::output);
    const int every = setup_.config.output.every;
    asked_ = directory_.has(output_request);
    if (asked_ || (every > 0 && iterate.iteration % every == 0))
      write_iteration_fields(setup_, directory_, {iterate.iteration}, pipeline, design.field,
                             state.process->displacement, check_build(setup_, pipeline, state).fields);
  }
  HistoryLine line{iterate, step, pipeline.iterations(), setup_.layers->variables(), design};
  line.seconds = clock_.end_iteration();
  line.interior_minima = count_interior_minima<Dim>(setup_.part, state.time->time);
  if (!state.time->temperature.empty())
    line.temperature_range = {state.time->lowest_temperature, state.time->highest_temperature};
  line.peak_memory_bytes = peak_memory_bytes(setup_.world());
  line.tolerance = pipeline.tolerances().primal.value;
  append_to_history(directory_, to_record(line));
  terminal_.iteration(iterate, line.seconds.total);
}

template <int Dim>
bool RunOutput<Dim>::keep(const RunState<Dim>& run, const Pipeline<Dim>& pipeline) {
  if (!checkpoints_.keep(run, pipeline, asked_)) return false;
  if (asked_) directory_.remove(output_request);
  asked_ = false;
  return true;
}

template <int Dim>
Summary RunOutput<Dim>::summary(const RunEnd& end) const {
  return {setup_.config.name,
          setup_.settings,
          end,
          size_of(setup_.world()),
          setup_.groups.count(),
          setup_.part.count(),
          clock_.so_far(),
          peak_memory_bytes(setup_.world()),
          setup_.config.optimizer.coarse_iterations,
          starts_,
          baseline_ ? &*baseline_ : nullptr,
          std::nullopt};
}

template <int Dim>
void RunOutput<Dim>::write_summary(const Summary& summary) const {
  directory_.write("summary.json", to_text(to_record(summary), 2) + "\n");
}

template <int Dim>
void RunOutput<Dim>::finish(const RunEnd& end, const FinalReports& reports, const BestIterate& best) {
  terminal_.end_progress();
  write_result(setup_, directory_, reports, *baseline_, best);
  Summary record = summary(end);
  record.finish.emplace(
      Finish{reports, best, setup_.layers->variables(), make_headline(reports, *baseline_, setup_.settings)});
  write_summary(record);
  terminal_.table(record, directory_.path());
}

template <int Dim>
void RunOutput<Dim>::stop(const Stopped& reason) {
  terminal_.end_progress();
  checkpoints_.write();
  write_summary(summary({"stopped", reason.what(), checkpoints_.iteration()}));
  remove_stop_files();
  print("checkpoint after iteration " + std::to_string(checkpoints_.iteration()) + " in '" +
        directory_.path() + "'; -restart continues");
}

template <int Dim>
void RunOutput<Dim>::fail(const NumericalError& error, const Pipeline<Dim>& pipeline) {
  terminal_.end_progress();
  try {
    checkpoints_.write();
    write_summary(summary({"failed", error.what(), checkpoints_.iteration()}));
    write_iteration_fields(setup_, directory_, {checkpoints_.iteration() + 1, /*failed=*/true}, pipeline,
                           checkpoints_.design(), {}, {});
  } catch (const OutputError& second) {
    warn(second.what());
  }
}

FABSEQ_INSTANTIATE_CLASS(RunOutput);

}  // namespace fabseq
