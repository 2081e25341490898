// SPDX-License-Identifier: MIT
#include "fabseq/output/checkpoints.h"

#include "fabseq/files/checkpoint.h"
#include "fabseq/files/history.h"

namespace fabseq {

template <int Dim>
void Checkpoints<Dim>::continue_from(const Restart& restart) {
  const auto position = static_cast<std::int64_t>(restart.state.number("history/bytes"));
  clock_.restore(restart.state);
  due_ = !restart.in_place;  // at once: this directory has none
  if (!restart.in_place) return copy_history(directory_, restart.directory, position);
  cut_history(directory_, position);
  // Should this have been the older slot because the newer is damaged, the next goes in the place of that
  // one.
  directory_.write("checkpoint/newest", restart.slot + "\n");
  written_ = restart.state.integer("iteration");
}

template <int Dim>
bool Checkpoints<Dim>::keep(const RunState<Dim>& run, const Pipeline<Dim>& pipeline, bool asked) {
  kept_ = run.save();
  pipeline.save(kept_);
  const int every = setup_.config.output.checkpoint_every;
  const bool is_time = every > 0 && run.completed() > 0 && (run.completed() % every == 0 || run.ended());
  if (!(is_time || asked || due_) || written_ == run.completed()) return false;
  write();
  return true;
}

template <int Dim>
void Checkpoints<Dim>::write() {
  if (written_ == iteration()) return;
  const auto scope = timer_.enter(Phase::output);
  save_problem(setup_, kept_);
  kept_.set_scalar("history/bytes", sync_history(directory_));
  clock_.save(kept_);
  write_checkpoint(directory_, setup_.design_layout(), kept_);
  written_ = iteration();
  due_ = false;
}

FABSEQ_INSTANTIATE_CLASS(Checkpoints);

}  // namespace fabseq
