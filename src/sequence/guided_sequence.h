// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence.h"
#include "sequence/averaging_filter.h"
#include "sequence/guided_problem.h"
#include "sequence/guided_settings.h"
#include "sequence/tilt_vectors.h"

#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// Pseudo-time that is guided by build directions (docs/formulation.md 2.4). The design of a part element is
/// its tilt vector a and, with a stretch, the logarithm s of its local thickness relative to the target. Both
/// pass the averaging filter and make the vectors that grad t follows,
///
///     v = e^-s d(a) / l_c.
///
/// The map from v to t is linear (GuidedProblem); t is neither clamped nor normalized.
template <int Dim>
class GuidedSequence : public Sequence<Dim> {
 public:
  /// `settings`: without anything that is left open. Part and `problem` are those of this design. Collective
  /// on the grid's communicator; the part must outlive the sequence.
  GuidedSequence(const Part<Dim>& part, const GuidedSettings& settings,
                 std::unique_ptr<GuidedProblem<Dim>> problem);

  bool has_design() const override { return true; }
  std::size_t variables() const override { return part_.elements().size() * settings_.components(Dim); }
  DesignSpace space() const override { return settings_.space(Dim); }
  std::vector<double> initial_design() const override;
  const PseudoTime<Dim>& update(std::span<const double> design) override;
  std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) override;
  void set_tolerance(const SolveTolerance& tolerance) override { problem_->set_tolerance(tolerance); }
  void start_cold() override { problem_->start_cold(); }
  void release_memory() override { problem_->release_memory(); }
  std::vector<int> adjoint_iterations() const override { return problem_->adjoint_iterations(); }

 private:
  using Filter = std::vector<double> (AveragingFilter<Dim>::*)(std::span<const double>) const;
  std::vector<double> filtered(std::span<const double> design, Filter filter) const;
  double density_of_layers(std::size_t element) const;
  std::vector<double> by_design(const std::vector<double>& d_vectors) const;

  const Part<Dim>& part_;
  GuidedSettings settings_;
  std::unique_ptr<GuidedProblem<Dim>> problem_;
  TiltVectors<Dim> tilts_;
  AveragingFilter<Dim> filter_;
  std::vector<double> guide_;  ///< the filtered design of the last update, [part element][component]
  PseudoTime<Dim> time_;
};

}  // namespace fabseq
