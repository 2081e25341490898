// SPDX-License-Identifier: MIT
/// What ends a run and what lets it go on: checkpoints, stops, failures.
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/files/checkpoint.h"
#include "fabseq/files/field_dump.h"
#include "fabseq/run/run_output.h"

#include <cstdio>

namespace fabseq {

/// Takes over what an earlier run left, up to its checkpoint.
template <int Dim>
void RunOutput<Dim>::continue_from(const Restart& restart) {
  const CheckpointState& state = restart.state;
  const auto position = static_cast<std::int64_t>(state.number("history/bytes"));
  for (int phase = 0; phase < phase_count; ++phase)
    phase_seconds_[phase] = state.number("seconds/" + std::string(phase_names[phase]));
  earlier_seconds_ = state.number("seconds/total");
  checkpoint_due_ = !restart.in_place;  // at once: this directory has none
  if (!restart.in_place) return history_.copy_from(restart.directory, position);
  history_.cut_back(position);
  // Should this have been the older slot because the newer is damaged, the next goes in the place of that
  // one.
  directory_.write("checkpoint/newest", restart.slot + "\n");
  checkpointed_ = state.integer("iteration");
}

template <int Dim>
bool RunOutput<Dim>::keep(const RunState<Dim>& run, const Pipeline<Dim>& pipeline) {
  kept_ = run.save();
  pipeline.save(kept_);
  const int every = setup_.config.output.checkpoint_every;
  const bool is_time = every > 0 && run.completed() > 0 && (run.completed() % every == 0 || run.ended());
  if (!(is_time || asked_ || checkpoint_due_) || checkpointed_ == run.completed()) return false;
  write_checkpoint();
  if (asked_) directory_.remove(output_request);
  asked_ = checkpoint_due_ = false;
  return true;
}

template <int Dim>
void RunOutput<Dim>::write_checkpoint() {
  const auto scope = timer_.enter(Phase::output);
  save_problem(setup_, kept_);
  kept_.set_scalar("history/bytes", history_.sync());
  for (int phase = 0; phase < phase_count; ++phase)
    kept_.set_scalar("seconds/" + std::string(phase_names[phase]), phase_seconds_[phase]);
  kept_.set_scalar("seconds/total", total_seconds());
  fabseq::write_checkpoint(directory_, setup_.design_layout(), kept_);
  checkpointed_ = kept_.integer("iteration");
}

template <int Dim>
void RunOutput<Dim>::stop(const Stopped& reason) {
  progress_.finish();
  if (checkpointed_ != kept_.integer("iteration")) write_checkpoint();
  write_end({"stopped", reason.what(), kept_.integer("iteration")});
  remove_stop_files();
  print("checkpoint after iteration " + std::to_string(*checkpointed_) + " in '" + directory_.path() +
        "'; -restart continues");
}

template <int Dim>
void RunOutput<Dim>::fail(const NumericalError& error, const Pipeline<Dim>& pipeline) {
  progress_.finish();
  try {
    if (checkpointed_ != kept_.integer("iteration")) write_checkpoint();
    write_end({"failed", error.what(), kept_.integer("iteration")});
    dump_failure(pipeline);
  } catch (const OutputError& second) {
    warn(second.what());
  }
}

template <int Dim>
void RunOutput<Dim>::write_end(const RunEnd& end) {
  Json record = summary(end);
  if (baseline_.block.is_object()) record["baseline"] = baseline_.block;
  directory_.write("summary.json", to_text(record, 2) + "\n");
}

/// For a look: the design that failed, and the pseudo-time and layers it led to.
template <int Dim>
void RunOutput<Dim>::dump_failure(const Pipeline<Dim>& pipeline) {
  const std::vector<double> design = setup_.design_field(kept_.field("design"));
  FieldSet<Dim> fields;
  fields.grid = &setup_.grid;
  fields.add_elements("density", setup_.part.density());
  fields.add(setup_.design_support.on_nodes(), "design", design);
  std::vector<double> time, layer;
  if (const PseudoTime<Dim>* last = pipeline.last_time(); last != nullptr) {
    time = setup_.part.expand(last->time);
    layer = setup_.part.expand(pipeline.last_layer_index());
    fields.add_elements("time", time);
    fields.add_elements("layer", layer);
    if (!last->temperature.empty()) fields.add_nodes("temperature", last->temperature);
  }
  directory_.make_folder("fields");
  char name[40];
  std::snprintf(name, sizeof name, "fields/iteration_%04d_failed", kept_.integer("iteration") + 1);
  write_field_dump(setup_.world(), fields, directory_.file(name));
}

#define FABSEQ_INSTANTIATE(Dim)                                                    \
  template void RunOutput<Dim>::continue_from(const Restart&);                     \
  template bool RunOutput<Dim>::keep(const RunState<Dim>&, const Pipeline<Dim>&);  \
  template void RunOutput<Dim>::write_checkpoint();                                \
  template void RunOutput<Dim>::stop(const Stopped&);                              \
  template void RunOutput<Dim>::fail(const NumericalError&, const Pipeline<Dim>&); \
  template void RunOutput<Dim>::write_end(const RunEnd&);                          \
  template void RunOutput<Dim>::dump_failure(const Pipeline<Dim>&);
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
