// SPDX-License-Identifier: MIT
/// \file
/// The stages that a config asks for, and their solvers.
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/optimize/setup.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/release.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/solve/elasticity_solver.h"
#include "fabseq/solve/reference/assembled_system.h"

#include <functional>
#include <memory>
#include <span>

namespace fabseq {

/// Makes the layers of a design, of its layer variables (none: those that the config says). `count`: of
/// curved layers; `beta`: their sharpness.
using LayerMaker = std::function<std::unique_ptr<Layers>(std::span<const double> variables, int count,
                                                         double beta, bool binary)>;

/// The sequence a config asks for.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_sequence(const Setup<Dim>& setup, double tolerance);
/// The layers a config asks for; those that cannot move the part beyond `tolerance` are left out. The setup
/// must outlive what is made.
template <int Dim>
LayerMaker make_layers(const Setup<Dim>& setup, double tolerance);
/// Layers between isosurfaces, at uniform times: those of the baseline.
template <int Dim>
LayerMaker make_uniform_layers(const Setup<Dim>& setup);
/// The planar sequence of the baseline.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_baseline_sequence(const Setup<Dim>& setup);

/// The elasticity solver of the path a config asks for. The setup and the model must outlive it.
template <int Dim>
std::unique_ptr<ElasticitySolver<Dim>> make_elasticity_solver(const Setup<Dim>& setup,
                                                              const ElasticModel<Dim>& model,
                                                              double tolerance);
/// Settings of the reference solvers: elasticity to `tolerance`, heat a thousand times closer (its error
/// enters all others).
AssembledSolverSettings elasticity_solver_settings(const Config& config, double tolerance);
AssembledSolverSettings heat_solver_settings(const Config& config, double tolerance);

/// The release's solver, to `tolerance`.
ReleaseSolver release_solver(const Config& config, double tolerance);

}  // namespace fabseq
