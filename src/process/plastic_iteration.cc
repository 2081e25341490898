// SPDX-License-Identifier: MIT
#include "process/plastic_iteration.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace fabseq {

namespace {

constexpr std::size_t depth = 5;  ///< of Anderson's method
constexpr int most_sweeps = 300;  ///< over a wave
/// Closeness where one cycle is too little: it hardly moves a piece that hangs in what is not built yet, and
/// sweeps would end because of that. The adjoint of such a step, 1e5 times as large as others, is a load of
/// the steps before it, which ten times the error would bury.
constexpr double closer(bool adjoint) { return adjoint ? 0.001 : 0.01; }
/// Closeness of the solves of a sweep, each one cycle but where pieces hang, beside which one step is enough.
/// Closer ones save no sweeps (docs/developer/experiments.md).
constexpr SolveTolerance one_cycle(bool adjoint) {
  return {.value = 0.5, .reach = 4.0, .of_islands = closer(adjoint), .correction = true};
}
/// The same of the release, which has no reach.
constexpr double of_release = 0.3;

/// Says when all solves have to be closer, after 30 sweeps of which the last 15 have not taken the step to
/// 0.3 of its size; and when sweeps move no further, since the last 30 have not halved the smallest step.
class Patience {
 public:
  void add(double step) {
    steps_.push_back(step);
    lost_ = lost_ || (steps_.size() >= 30 && step > 0.3 * steps_[steps_.size() - 16]);
  }
  bool is_lost() const { return lost_; }
  bool is_stuck() const {
    if (!lost_ || steps_.size() < 60) return false;
    const auto last = steps_.end() - 30;
    return *std::min_element(last, steps_.end()) > 0.5 * *std::min_element(steps_.begin(), last);
  }

 private:
  std::vector<double> steps_;
  bool lost_ = false;
};

/// Change that is close enough where sweeps move no further: a piece that hangs in what is not built yet
/// moves by what rounding leaves of its forces, over a stiffness of 1e-9.
constexpr double as_rounding_leaves = 1e-6;

}  // namespace

void PlasticIteration::set_wave(const PlasticWave& wave, bool changed) {
  wave_ = wave;
  systems_.groups().run([&] {
    std::vector<double> stiffness;
    if (wave_.block)
      stiffness = systems_.set_operators(
          input_.densities, *wave_.block, changed,
          [this](const BlockRegion& block, std::span<double> factors) { scale(block, factors); });
    else if (wave_.release)
      stiffness = systems_.model().finished_stiffness();
    set_weights(stiffness);
  });
}

void PlasticIteration::scale(const BlockRegion& block, std::span<double> stiffness) const {
  if (!input_.heated()) return;
  const int lanes = block.block.lanes;
  for (int lane = 0; lane < lanes; ++lane) {
    const std::vector<double>& temperature = input_.temperatures->elements[block.block.first + lane];
    for (std::size_t e = 0; e < temperature.size(); ++e)
      stiffness[e * lanes + lane] *= curves_.young(temperature[e]);
  }
}

void PlasticIteration::set_weights(std::span<const double> stiffness) {
  const std::vector<int>& nodes = systems_.model().nodes;
  const int lanes = wave_.lanes(systems_.groups().index());
  weights_.resize(nodes.size() * 3 * lanes);
  if (lanes == 0) return;
  const LaneVector nodal = systems_.elements().at_nodes(stiffness, lanes);
  auto to = weights_.begin();
  for (const int node : nodes)
    for (int a = 0; a < 3; ++a)
      for (int lane = 0; lane < lanes; ++lane)
        *to++ = static_cast<float>(nodal(static_cast<std::size_t>(node), lane));
}

Anderson PlasticIteration::make_anderson() const { return {systems_.groups().world(), depth}; }

void PlasticIteration::release_memory() {
  anderson_ = make_anderson();
  for (LaneVector* vector : {&forces_, &solution_, &step_}) *vector = {};
}

/// Sets the step of the unknowns that the forces lead to: what they would do, the other way round.
void PlasticIteration::correct(bool adjoint) {
  const int lanes = wave_.lanes(systems_.groups().index());
  resize(step_, static_cast<int>(systems_.model().nodes.size()), 3, lanes);
  hangs_.assign(static_cast<std::size_t>(lanes), 0);
  systems_.groups().run([&] {
    if (lanes == 0) return;
    double sign = -1.0;
    if (wave_.release) {
      resize(solution_, systems_.owned_nodes(), 3, 1);
      sign = 1.0;
      solution_.values = adjoint ? release_->adjoint(forces_.values) : release_->displacement(forces_.values);
    } else {
      const auto reports =
          systems_.solve_current(*wave_.block, forces_, solution_, adjoint ? "adjoint" : "forward");
      std::ranges::transform(reports, hangs_.begin(), [](const SolveReport& report) {
        return static_cast<char>(report.has_islands ? 1 : 0);
      });
    }
    pick(solution_, systems_.model().nodes, step_, sign);
  });
}

void PlasticIteration::set_tolerance(const SolveTolerance& of_steps, double release) {
  systems_.set_tolerance(of_steps);
  if (release_ != nullptr) release_->set_tolerance(release);
}

/// Weights for adjoints, if pieces hang in a step; empty: those of the wave. What moves such a piece is 1e5
/// times as large as the adjoints of other steps, whose changes would not count beside it: the step is to
/// count as much as the largest of the others in the wave, or as those so far do on average.
std::vector<float> PlasticIteration::leveled_weights(const LaneVector& unknowns) const {
  const MPI_Comm world = systems_.groups().world();
  const bool hangs = std::ranges::find(hangs_, 1) != hangs_.end();
  if (max(world, hangs ? 1.0 : 0.0) == 0.0) return {};
  const auto lanes = static_cast<std::size_t>(step_.lanes);
  std::vector<double> squares(2 * lanes, 0.0);
  for (std::size_t i = 0; i < step_.values.size(); ++i) {
    const double weight = weights_[i];
    squares[i % lanes] += weight * unknowns.values[i] * unknowns.values[i];
    squares[lanes + i % lanes] += weight * step_.values[i] * step_.values[i];
  }
  sum_in_place(systems_.model().part.grid().comm(), std::span<double>(squares));
  double largest = steps_ > 0 ? square_ / steps_ : 0.0;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    squares[lane] = std::max(squares[lane], squares[lanes + lane]);
    if (hangs_[lane] == 0) largest = std::max(largest, squares[lane]);
  }
  largest = max(world, largest);
  std::vector<float> result = weights_;
  for (std::size_t i = 0; largest > 0.0 && i < result.size(); ++i)
    if (const std::size_t lane = i % lanes; hangs_[lane] != 0 && squares[lane] > largest)
      result[i] = static_cast<float>(result[i] * (largest / squares[lane]));
  return result;
}

void PlasticIteration::warn_of_rounding(double reached, double change) const {
  const std::string what = wave_.release ? "release"
                                         : formatted("layers %d to %d", input_.steps[wave_.first].layer + 1,
                                                     input_.steps[wave_.first + wave_.count - 1].layer + 1);
  warn(systems_.groups().world(),
       formatted(
           "%s: plastic flow: sweeps end at changes of %.1e, not %.1e: rounding moves what hangs in the air",
           what.c_str(), reached, change));
}

int PlasticIteration::solve(LaneVector& unknowns, const Forces& forces, bool adjoint, double change) {
  std::vector<float> leveled;
  Patience patience;
  set_tolerance(one_cycle(adjoint), of_release);
  for (int sweep = 1; sweep <= most_sweeps; ++sweep) {
    if (patience.is_lost())
      set_tolerance({.value = closer(adjoint), .correction = true}, closer(/*adjoint=*/false));
    forces(unknowns, forces_);
    correct(adjoint);
    if (sweep == 1) {
      if (adjoint) leveled = leveled_weights(unknowns);
      anderson_.start(leveled.empty() ? weights_ : leveled);
    }
    const Anderson::Norms norms = anderson_.advance(unknowns.values, step_.values);
    patience.add(norms.step);
    const double all_square = square_ + norms.x * norms.x, size = std::sqrt(all_square);
    if (!std::isfinite(norms.step + norms.x)) break;
    const double allowed = patience.is_stuck() ? std::max(change, as_rounding_leaves) : change;
    if (norms.step > allowed * size) continue;
    if (norms.step > change * size) warn_of_rounding(norms.step / size, change);
    square_ = all_square;
    steps_ += wave_.count;
    return sweep;
  }
  throw NumericalError(formatted("%s: sweeps do not bring %s to changes of %g",
                                 wave_.release ? "release" : "process",
                                 adjoint ? "its adjoint displacements" : "displacements", change));
}

}  // namespace fabseq
