// SPDX-License-Identifier: MIT
#include "fabseq/output/run_clock.h"

#include <mpi.h>

#include <string>

namespace fabseq {

namespace {

std::string name_of(int phase) { return "seconds/" + std::string(phase_names[phase]); }

}  // namespace

Json seconds_record(const Seconds& seconds) {
  Json record = Json::object();
  for (int phase = 0; phase < phase_count; ++phase)
    record[std::string(phase_names[phase])] = seconds.phases[phase];
  record["total"] = seconds.total;
  return record;
}

RunClock::RunClock(PhaseTimer& timer) : timer_(timer), start_(MPI_Wtime()), iteration_start_(start_) {}

void RunClock::begin_iterations() {
  timer_.reset();
  iteration_start_ = MPI_Wtime();
}

Seconds RunClock::end_iteration() {
  const Seconds seconds{timer_.seconds(), MPI_Wtime() - iteration_start_};
  for (int phase = 0; phase < phase_count; ++phase) earlier_.phases[phase] += seconds.phases[phase];
  iteration_start_ += seconds.total;
  timer_.reset();
  return seconds;
}

Seconds RunClock::so_far() const {
  Seconds seconds = earlier_;
  seconds.total += MPI_Wtime() - start_;
  return seconds;
}

void RunClock::save(CheckpointState& state) const {
  const Seconds seconds = so_far();
  for (int phase = 0; phase < phase_count; ++phase) state.set_scalar(name_of(phase), seconds.phases[phase]);
  state.set_scalar("seconds/total", seconds.total);
}

void RunClock::restore(const CheckpointState& state) {
  for (int phase = 0; phase < phase_count; ++phase) earlier_.phases[phase] = state.number(name_of(phase));
  earlier_.total = state.number("seconds/total");
}

}  // namespace fabseq
