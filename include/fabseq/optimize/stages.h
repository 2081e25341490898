// SPDX-License-Identifier: MIT
/// \file
/// The stages that a model asks for, and their solvers.
#pragma once

#include "fabseq/optimize/model.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/release.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/solve/elasticity_solver.h"

#include <memory>

namespace fabseq {

/// The sequence a model asks for.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_sequence(const Model<Dim>& model, double tolerance);
/// The planar sequence of the baseline.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_baseline_sequence(const Model<Dim>& model);

/// The elasticity solver of the path a model asks for. Both models must outlive it.
template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> make_elasticity_solver(const Model<Dim>& model,
                                                              const ElasticModel<Dim>& elastic,
                                                              double tolerance);
/// The release's solver, to `tolerance`.
ReleaseSolver release_solver(const SolverSettings& settings, double tolerance);

}  // namespace fabseq
